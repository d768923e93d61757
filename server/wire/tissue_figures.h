#pragma once

#include <optional>
#include <string>

#include "core/anatomy/tissue_presets.h"
#include "lipofill/v1/model.pb.h"

namespace lipofill::server {

/// The kind of tissue a layer is of: as it says, else as its name does, else none.
std::optional<anatomy::TissueKind> kind_of(const v1::TissueLayer& layer);

/// The specification with what its preset of tissue fills in; as it is without a preset. Layers of
/// no known kind stay as they are, and so does every figure that is given. Doing it twice is doing
/// it once. Checked by tests/unit/server/wire/tissue_figures_test.cc.
v1::ModelSpec fill_tissue_figures(v1::ModelSpec spec);

/// Explains which figure a layer leaves out.
std::string describe_missing_figure(const v1::ModelSpec& spec, const v1::TissueLayer& layer);

}  // namespace lipofill::server
