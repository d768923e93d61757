#include "absl/strings/str_cat.h"
#include "server/store/plan_rows.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

#define REVISION_IS_WHOLE IS_WHOLE("plan_revisions", PLAN_REVISION_COLUMNS)
#define RUN_IS_WHOLE IS_WHOLE("plan_runs", PLAN_RUN_COLUMNS)

std::string revision_name(const std::string& patient, const std::string& id, uint64_t number) {
  return absl::StrCat(plan_name(patient, id), " (its revision ", number, ")");
}

PlanRevisionRecord revision_of(const Query& row) {
  return {row.unsigned_integer(0), row.text(1), row.text(2), row.integer(3)};
}

absl::Status change_run_hash(Database& database, const PlanRunRecord& run) {
  Query update(database, "UPDATE plan_runs SET content_hash = ? WHERE simulation = ?");
  return update.bind(run.content_hash, run.simulation).run();
}

}  // namespace

absl::StatusOr<std::vector<PlanRevisionRecord>> SqlStore::list_plan_revisions(const std::string& patient,
                                                                              const std::string& id) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<PlanRevisionRecord>> {
    if (const auto plan = read_plan(*database_, patient, id); !plan.ok()) return plan.status();
    Query query(*database_, "SELECT number, content, changes, create_time_us, " REVISION_IS_WHOLE
                            " FROM plan_revisions WHERE patient = ? AND plan = ? ORDER BY number DESC");
    query.bind(patient, id);
    std::vector<PlanRevisionRecord> revisions;
    while (query.next()) {
      if (!query.is_true(4)) return damaged_record(revision_name(patient, id, query.unsigned_integer(0)));
      revisions.push_back(revision_of(query));
    }
    if (!query.status().ok()) return query.status();
    return revisions;
  });
}

absl::StatusOr<PlanRevisionRecord> SqlStore::get_plan_revision(const std::string& patient, const std::string& id,
                                                               uint64_t number) {
  return turns_.look([&]() -> absl::StatusOr<PlanRevisionRecord> {
    if (const auto plan = read_plan(*database_, patient, id); !plan.ok()) return plan.status();
    Query query(*database_, "SELECT number, content, changes, create_time_us, " REVISION_IS_WHOLE
                            " FROM plan_revisions WHERE patient = ? AND plan = ? AND number = ?");
    if (query.bind(patient, id, number).next()) {
      if (!query.is_true(4)) return damaged_record(revision_name(patient, id, number));
      return revision_of(query);
    }
    if (!query.status().ok()) return query.status();
    Query kept(*database_, "SELECT min(number), max(number) FROM plan_revisions WHERE patient = ? AND plan = ?");
    if (!kept.bind(patient, id).next()) return kept.status();
    return absl::NotFoundError(absl::StrCat(plan_name(patient, id), " has no revision ", number, "; those from ",
                                            kept.integer(0), " to ", kept.integer(1), " are kept"));
  });
}

absl::Status SqlStore::add_plan_run(const std::string& patient, const std::string& id, const PlanRunRecord& run) {
  return turns_.transact([&]() -> absl::Status {
    if (const auto plan = read_plan(*database_, patient, id); !plan.ok()) return plan.status();
    if (const auto simulation = read_simulation(run.simulation); !simulation.ok()) return simulation.status();
    Query present(*database_, "SELECT patient, plan FROM plan_runs WHERE simulation = ?");
    if (present.bind(run.simulation).next()) {
      if (present.text(0) == patient && present.text(1) == id) return change_run_hash(*database_, run);
      return absl::AlreadyExistsError(absl::StrCat(simulation_name(run.simulation), " was made from ",
                                                   plan_name(present.text(0), present.text(1))));
    }
    if (!present.status().ok()) return present.status();
    Query insert(*database_, "INSERT INTO plan_runs (" PLAN_RUN_COLUMNS ") VALUES (?, ?, ?, ?, ?)");
    return insert.bind(run.simulation, patient, id, run.content_hash, run.create_time_us).run();
  });
}

absl::StatusOr<std::vector<PlanRunRecord>> SqlStore::list_plan_runs(const std::string& patient, const std::string& id) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<PlanRunRecord>> {
    Query query(*database_,
                "SELECT simulation, content_hash, create_time_us, " RUN_IS_WHOLE
                " FROM plan_runs WHERE patient = ? AND plan = ? ORDER BY create_time_us DESC, simulation LIMIT ?");
    query.bind(patient, id, kMaxRunsOfPlan);
    std::vector<PlanRunRecord> runs;
    while (query.next()) {
      if (!query.is_true(3)) return damaged_record(absl::StrCat(plan_name(patient, id), " (a run)"));
      runs.push_back({query.text(0), query.text(1), query.integer(2)});
    }
    if (!query.status().ok()) return query.status();
    return runs;
  });
}

}  // namespace lipofill::server
