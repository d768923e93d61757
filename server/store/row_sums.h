#pragma once

#include <array>
#include <string>

#include "absl/status/status.h"

// The columns of every table that are summed, in the order of their sum. They are macros so that
// statements are literals.
#define PATIENT_COLUMNS "id, display_name, create_time_us, tenant"
#define LABEL_COLUMNS "patient, key, value"
#define SCAN_COLUMNS "patient, id, format, unit, size_bytes, sha256, received_bytes, complete, report, create_time_us"
#define MODEL_COLUMNS "patient, id, scan, content_hash, spec, report, create_time_us, bone_scan"
#define SIMULATION_COLUMNS \
  "id, model, display_name, spec, state, reason, summary, create_time_us, origin, tenant, epoch"
#define RESULT_COLUMNS "simulation, meshes, frame"
#define SERIES_COLUMNS "simulation, first_step, last_step, rows"
#define REQUEST_COLUMNS "tenant, method, id, fingerprint, name"
#define COMMAND_COLUMNS "simulation, number, kind, step, payload, on_course, create_time_us"
#define CHECKPOINT_COLUMNS                                                                                \
  "simulation, id, kind, on_course, step, time_s, wall_s, last_command, size_bytes, sha256, state_hash, " \
  "create_time_us"

#define PLAN_COLUMNS "patient, id, revision, scan, target, content, create_time_us, update_time_us"
#define PLAN_REVISION_COLUMNS "patient, plan, number, content, changes, create_time_us"
#define OPERATION_COLUMNS \
  "id, patient, tenant, method, request_id, fingerprint, request, done, response, create_time_us"
#define OPERATION_PART_COLUMNS "operation, number, bytes"
#define PLAN_RUN_COLUMNS "simulation, patient, plan, content_hash, create_time_us"

/// An expression that is 1 for a row that is what was written, else 0.
#define IS_WHOLE(table, columns) "sum = row_sum('" table "', " columns ")"

namespace lipofill::server {

/// A table whose rows are summed: its column `sum` holds the SHA-256 of the table's name and all
/// other columns.
struct SummedTable {
  const char* name;
  const char* columns;  ///< those that are summed, with ", " between them
  const char* key;      ///< the columns that tell its rows apart
  const char* named;    ///< columns that tell what a row is of
  const char* title;    ///< the name of what a row is of, with $0 for the first of these
  int since = 5;        ///< version of the schema from which on it is there and summed
};

/// Every table that keeps something of a user.
extern const std::array<SummedTable, 15> kSummedTables;

/// The statements that give every table which comes after a version of the schema its sums: the
/// column, the sums of the rows that are there, and the triggers that sum a row when it is written,
/// and refuse to change one that is not what was written, so that damage is never summed anew.
/// Checked by tests/unit/server/store/row_sums_test.cc.
std::string make_row_sums(int version);

/// The statement that tells of every row of a table what it is of, by the columns of `named`, and
/// whether it is what was written. Where values have types of their own, as in SQLite, a text is
/// not: it has the sum of the same bytes, but nothing is written as text, and nothing finds one.
std::string check_rows(const SummedTable& table, bool has_types);

/// Puts a prefix before each of the columns: "NEW." makes "NEW.id, NEW.display_name".
std::string with_prefix(const std::string& prefix, const std::string& columns);

/// DATA_LOSS for the record of a resource that is not what was written.
absl::Status damaged_record(const std::string& name);

}  // namespace lipofill::server
