#pragma once

#include <filesystem>

#include "client/cpp/plan_file.h"
#include "lipofill/v1/patient_service.pb.h"

namespace lipofill::client {

/// A plan that a daemon has changed, as a file for `folder`: the model as it was built, the
/// simulation as it was changed, scans named from there.
v1::Plan plan_file_of(const PlanFile& from, const v1::Model& model, const v1::SimulationSpec& changed,
                      const std::filesystem::path& folder);

}  // namespace lipofill::client
