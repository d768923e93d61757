#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "client/cpp/records/finished_plan.h"
#include "client/cpp/records/record_study.h"

namespace lipofill::client {

/// The figures of a plan as a Comprehensive SR (PS3.3, A.35.3): a group of measurements for the
/// whole plan, one for each zone and, where the result was held against a target, one for that.
/// Units are UCUM's (mL, mm, Pa). Concepts without a standard code are of the scheme 99LIPOFILL.
/// The report is complete and unverified: nobody has signed it. INVALID_ARGUMENT for a summary
/// without figures. Checked by tests/unit/client/records_test.cc.
absl::StatusOr<std::unique_ptr<DcmDataset>> make_figures_record(const RecordStudy& study, const FinishedPlan& plan);

}  // namespace lipofill::client
