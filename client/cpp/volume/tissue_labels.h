#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

/// A tissue that a label map may know, from the skin inwards; metal lies anywhere.
enum class Tissue { kSkin, kFat, kMuscle, kBone, kMetal };

const char* name_of(Tissue tissue);

/// The tissue that a segmentation means by a name, in English, German or Latin: "Skin", "SAT",
/// "M. masseter", "Unterkiefer", "upper_skull"; none for others, such as "airway". Checked by
/// tests/unit/client/tissue_labels_test.cc.
std::optional<Tissue> tissue_named(std::string_view name);

/// Labels of a map are these tissues, by their numbers.
using TissueLabels = std::map<int64_t, Tissue>;

/// The tissues of a label map: those its names say, and over them what the caller says.
/// @param said  "skin=1", "bone=jaw": a tissue and the number or the name of a label
/// INVALID_ARGUMENT for what is no such pair, and for a name that the map does not have, with the
/// names it has. Checked by tests/unit/client/tissue_labels_test.cc.
absl::StatusOr<TissueLabels> find_tissue_labels(const std::filesystem::path& source, const LabelNames& names,
                                                const std::vector<std::string>& said);

/// The label of a number or of a name as the map has it, in any case of its letters.
/// INVALID_ARGUMENT, with the names there are, for a name that it does not have.
absl::StatusOr<int64_t> find_label(const std::filesystem::path& source, const LabelNames& names,
                                   const std::string& wanted);

/// The numbers of the labels that the caller wants: "4", "Mandible", a tissue such as "bone", which
/// is every label of that tissue, or "all", which is every label but 0 and comes as an empty list.
/// INVALID_ARGUMENT for what the map does not have.
absl::StatusOr<std::vector<int64_t>> choose_labels(const std::filesystem::path& source, const LabelNames& names,
                                                   const std::vector<std::string>& wanted);

}  // namespace lipofill::client
