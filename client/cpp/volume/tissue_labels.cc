#include "client/cpp/volume/tissue_labels.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

/// A word that begins so tells the tissue. The first in this order that a name has counts: "fat of
/// the skin" is fat, "skin over bone" is skin.
constexpr std::pair<const char*, Tissue> kWords[] = {{"metal", Tissue::kMetal},
                                                     {"implant", Tissue::kMetal},
                                                     {"amalgam", Tissue::kMetal},
                                                     {"filling", Tissue::kMetal},
                                                     {"fat", Tissue::kFat},
                                                     {"fett", Tissue::kFat},
                                                     {"adipos", Tissue::kFat},
                                                     {"subcutan", Tissue::kFat},
                                                     {"subkutan", Tissue::kFat},
                                                     {"hypodermis", Tissue::kFat},
                                                     {"sat", Tissue::kFat},
                                                     {"skin", Tissue::kSkin},
                                                     {"cutis", Tissue::kSkin},
                                                     {"dermis", Tissue::kSkin},
                                                     {"epidermis", Tissue::kSkin},
                                                     {"haut", Tissue::kSkin},
                                                     {"muscle", Tissue::kMuscle},
                                                     {"muscul", Tissue::kMuscle},
                                                     {"muskel", Tissue::kMuscle},
                                                     {"masseter", Tissue::kMuscle},
                                                     {"temporalis", Tissue::kMuscle},
                                                     {"buccinator", Tissue::kMuscle},
                                                     {"pterygoid", Tissue::kMuscle},
                                                     {"zygomaticus", Tissue::kMuscle},
                                                     {"orbicularis", Tissue::kMuscle},
                                                     {"platysma", Tissue::kMuscle},
                                                     {"digastric", Tissue::kMuscle},
                                                     {"mylohyoid", Tissue::kMuscle},
                                                     {"tongue", Tissue::kMuscle},
                                                     {"bone", Tissue::kBone},
                                                     {"knochen", Tissue::kBone},
                                                     {"skull", Tissue::kBone},
                                                     {"crani", Tissue::kBone},
                                                     {"mandib", Tissue::kBone},
                                                     {"maxill", Tissue::kBone},
                                                     {"jaw", Tissue::kBone},
                                                     {"kiefer", Tissue::kBone},
                                                     {"unterkiefer", Tissue::kBone},
                                                     {"oberkiefer", Tissue::kBone},
                                                     {"schaedel", Tissue::kBone},
                                                     {"zygoma", Tissue::kBone},
                                                     {"teeth", Tissue::kBone},
                                                     {"tooth", Tissue::kBone},
                                                     {"dentition", Tissue::kBone},
                                                     {"dental", Tissue::kBone},
                                                     {"zahn", Tissue::kBone},
                                                     {"orbit", Tissue::kBone},
                                                     {"vertebra", Tissue::kBone},
                                                     {"cervical", Tissue::kBone},
                                                     {"hyoid", Tissue::kBone},
                                                     {"cortical", Tissue::kBone},
                                                     {"os", Tissue::kBone}};

/// Short words count whole: "sat" is no "satin", "os" no "osseous part".
constexpr size_t kShort = 3;

/// Leaves the ASCII letters of a name, in lower case; all else becomes blanks.
std::string words_of(std::string_view name) {
  std::string words(name);
  for (char& c : words) {
    c = absl::ascii_isalpha(static_cast<unsigned char>(c)) ? absl::ascii_tolower(static_cast<unsigned char>(c)) : ' ';
  }
  return words;
}

bool tells(absl::string_view word, absl::string_view beginning) {
  return beginning.size() <= kShort ? word == beginning : absl::StartsWith(word, beginning);
}

std::string names_there_are(const LabelNames& names) {
  if (names.empty()) return "it names none of its labels: give their numbers";
  const std::string all = absl::StrJoin(names, ", ", [](std::string* out, const auto& label) {
    absl::StrAppend(out, label.second, " (", label.first, ")");
  });
  return absl::StrCat("there are ", all);
}

std::optional<Tissue> tissue_called(absl::string_view name) {
  for (const Tissue tissue : {Tissue::kSkin, Tissue::kFat, Tissue::kMuscle, Tissue::kBone, Tissue::kMetal}) {
    if (name == name_of(tissue)) return tissue;
  }
  return std::nullopt;
}

}  // namespace

const char* name_of(Tissue tissue) {
  switch (tissue) {
    case Tissue::kSkin:
      return "skin";
    case Tissue::kFat:
      return "fat";
    case Tissue::kMuscle:
      return "muscle";
    case Tissue::kBone:
      return "bone";
    case Tissue::kMetal:
      return "metal";
  }
  return "";
}

std::optional<Tissue> tissue_named(std::string_view name) {
  const std::string words = words_of(name);
  const std::vector<absl::string_view> parts = absl::StrSplit(words, ' ', absl::SkipEmpty());
  for (const auto& [beginning, tissue] : kWords) {
    for (const absl::string_view word : parts) {
      if (tells(word, beginning)) return tissue;
    }
  }
  return std::nullopt;
}

absl::StatusOr<int64_t> find_label(const std::filesystem::path& source, const LabelNames& names,
                                   const std::string& wanted) {
  int64_t number = 0;
  if (absl::SimpleAtoi(wanted, &number)) return number;
  for (const auto& [label, name] : names) {
    if (absl::EqualsIgnoreCase(name, wanted)) return label;
  }
  return bad_volume(source, absl::StrCat("has no label named \"", wanted, "\"; ", names_there_are(names)));
}

absl::StatusOr<TissueLabels> find_tissue_labels(const std::filesystem::path& source, const LabelNames& names,
                                                const std::vector<std::string>& said) {
  TissueLabels labels;
  for (const auto& [label, name] : names) {
    if (const auto tissue = tissue_named(name)) labels[label] = *tissue;
  }
  for (const std::string& each : said) {
    const std::pair<std::string, std::string> pair = absl::StrSplit(each, absl::MaxSplits('=', 1));
    const auto tissue = tissue_called(pair.first);
    if (!tissue || pair.second.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(
          "label \"", each, "\" is no tissue and label, such as bone=4 or bone=Mandible; tissues are skin, fat, ",
          "muscle, bone and metal"));
    }
    const auto label = find_label(source, names, pair.second);
    if (!label.ok()) return label.status();
    labels[*label] = *tissue;
  }
  return labels;
}

absl::StatusOr<std::vector<int64_t>> choose_labels(const std::filesystem::path& source, const LabelNames& names,
                                                   const std::vector<std::string>& wanted) {
  std::vector<int64_t> labels;
  for (const std::string& each : wanted) {
    if (each == "all") return std::vector<int64_t>();
    const auto tissue = tissue_called(each);
    const size_t before = labels.size();
    for (const auto& [label, name] : names) {
      if (tissue && tissue_named(name) == tissue) labels.push_back(label);
    }
    if (labels.size() > before) continue;
    const auto label = find_label(source, names, each);
    if (!label.ok()) return label.status();
    labels.push_back(*label);
  }
  return labels;
}

}  // namespace lipofill::client
