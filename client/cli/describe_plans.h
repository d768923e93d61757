#pragma once

#include <string>

#include "lipofill/v1/plan_service.pb.h"

namespace lipofill::client {

// These describe plans that are kept for people: in a few lines, or in one line where it stands in
// a list.
std::string describe(const v1::SavedPlan& plan);
std::string describe(const v1::PlanRevision& revision);
std::string list_line(const v1::SavedPlan& plan);

}  // namespace lipofill::client
