#include "server/store/row_sums.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/substitute.h"

namespace lipofill::server {
namespace {

std::string is_new_row(const SummedTable& table) {
  const std::vector<std::string> columns = absl::StrSplit(table.key, ", ");
  return absl::StrJoin(columns, " AND ", [](std::string* text, const std::string& column) {
    absl::StrAppend(text, column, " = NEW.", column);
  });
}

// $0 table, $1 columns, $2 the same of the new row, $3 of the old one, $4 which row is the new one.
constexpr char kStatements[] = R"(
ALTER TABLE $0 ADD COLUMN sum BLOB NOT NULL DEFAULT x'';
UPDATE $0 SET sum = row_sum('$0', $1);
CREATE TRIGGER $0_are_summed AFTER INSERT ON $0 WHEN NEW.sum = x''
  BEGIN UPDATE $0 SET sum = row_sum('$0', $2) WHERE $4; END;
CREATE TRIGGER $0_are_checked BEFORE UPDATE OF $1 ON $0 WHEN OLD.sum <> row_sum('$0', $3)
  BEGIN SELECT RAISE(ABORT, 'a record among $0 is not what was written'); END;
CREATE TRIGGER $0_are_summed_anew AFTER UPDATE OF $1 ON $0
  BEGIN UPDATE $0 SET sum = row_sum('$0', $2) WHERE $4; END;
)";

}  // namespace

std::string with_prefix(const std::string& prefix, const std::string& columns) {
  return absl::StrCat(prefix, absl::StrReplaceAll(columns, {{", ", absl::StrCat(", ", prefix)}}));
}

const std::array<SummedTable, 15> kSummedTables = {{
    {"patients", PATIENT_COLUMNS, "id", "id", "patients/$0"},
    {"patient_labels", LABEL_COLUMNS, "patient, key", "patient", "patients/$0 (a label)"},
    {"scans", SCAN_COLUMNS, "patient, id", "patient, id", "patients/$0/scans/$1"},
    {"models", MODEL_COLUMNS, "patient, id", "patient, id", "patients/$0/models/$1"},
    {"simulations", SIMULATION_COLUMNS, "id", "id", "simulations/$0"},
    {"simulation_results", RESULT_COLUMNS, "simulation", "simulation", "simulations/$0 (its result)"},
    {"simulation_series", SERIES_COLUMNS, "simulation, last_step", "simulation, first_step, last_step",
     "simulations/$0 (its series, steps $1 to $2)"},
    {"requests", REQUEST_COLUMNS, "tenant, method, id", "name", "$0 (the request that made it)"},
    {"simulation_commands", COMMAND_COLUMNS, "simulation, number", "simulation, number",
     "simulations/$0 (its command $1)"},
    {"checkpoints", CHECKPOINT_COLUMNS, "simulation, id", "simulation, id", "simulations/$0/checkpoints/$1"},
    {"plans", PLAN_COLUMNS, "patient, id", "patient, id", "patients/$0/plans/$1", 6},
    {"plan_revisions", PLAN_REVISION_COLUMNS, "patient, plan, number", "patient, plan, number",
     "patients/$0/plans/$1 (its revision $2)", 6},
    {"plan_runs", PLAN_RUN_COLUMNS, "simulation", "patient, plan", "patients/$0/plans/$1 (a run)", 6},
    {"operations", OPERATION_COLUMNS, "id", "id", "operations/$0", 7},
    {"operation_parts", OPERATION_PART_COLUMNS, "operation, number", "operation, number", "operations/$0 (its part $1)",
     7},
}};

std::string check_rows(const SummedTable& table, bool has_types) {
  std::string is_whole = absl::StrCat("sum = row_sum('", table.name, "', ", table.columns, ")");
  if (has_types) {
    const std::string types = absl::StrReplaceAll(table.columns, {{", ", "), typeof("}});
    absl::StrAppend(&is_whole, " AND 'text' NOT IN (typeof(", types, "))");
  }
  return absl::StrCat("SELECT ", is_whole, ", ", table.named, " FROM ", table.name, " ORDER BY ", table.key);
}

std::string make_row_sums(int version) {
  std::string statements;
  for (const SummedTable& table : kSummedTables) {
    if (table.since <= version) continue;
    absl::StrAppend(&statements,
                    absl::Substitute(kStatements, table.name, table.columns, with_prefix("NEW.", table.columns),
                                     with_prefix("OLD.", table.columns), is_new_row(table)));
  }
  return statements;
}

absl::Status damaged_record(const std::string& name) {
  return absl::DataLossError(absl::StrCat(
      name, " is damaged: what the store has of it is not what was written; delete it, or restore a backup"));
}

}  // namespace lipofill::server
