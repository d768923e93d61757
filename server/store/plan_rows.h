#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/database.h"
#include "server/store/plan_records.h"

namespace lipofill::server {

/// The rows of plans. Who calls these holds the database for themselves, and is in a transaction
/// where they write.

/// NOT_FOUND for a plan that is not there, DATA_LOSS for one that is damaged.
absl::StatusOr<PlanRecord> read_plan(Database& database, const std::string& patient, const std::string& id);

/// Returns OK while its patient has room for a plan more: FAILED_PRECONDITION.
absl::Status check_plan_fits(Database& database, const std::string& patient);

/// Returns OK when the scans that a plan names are those of its patient: NOT_FOUND.
absl::Status check_scans_of(Database& database, const PlanRecord& plan);

/// Keeps a revision, and lets the oldest go that are too many or too much.
absl::Status write_plan_revision(Database& database, const PlanRecord& plan);

/// A row of a list: one that is damaged is named and no more. Its columns are PLAN_COLUMNS, and
/// whether it is whole.
PlanRecord listed_plan_of(const Query& row);

}  // namespace lipofill::server
