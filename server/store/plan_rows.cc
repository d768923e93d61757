#include "server/store/plan_rows.h"

#include "absl/strings/str_cat.h"
#include "server/store/plan_store.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"

namespace lipofill::server {
namespace {

PlanRecord plan_of(const Query& row) {
  PlanRecord plan;
  plan.patient = row.text(0);
  plan.id = row.text(1);
  plan.revision = row.unsigned_integer(2);
  plan.scan = row.text(3);
  plan.target = row.text(4);
  plan.content_message = row.text(5);
  plan.create_time_us = row.integer(6);
  plan.update_time_us = row.integer(7);
  return plan;
}

}  // namespace

absl::StatusOr<PlanRecord> read_plan(Database& database, const std::string& patient, const std::string& id) {
  Query query(database,
              "SELECT " PLAN_COLUMNS ", " IS_WHOLE("plans", PLAN_COLUMNS) " FROM plans WHERE patient = ? AND id = ?");
  if (!query.bind(patient, id).next()) {
    return query.status().ok() ? absl::NotFoundError(absl::StrCat("there is no ", plan_name(patient, id)))
                               : query.status();
  }
  if (!query.is_true(8)) return damaged_record(plan_name(patient, id));
  return plan_of(query);
}

absl::Status check_plan_fits(Database& database, const std::string& patient) {
  Query count(database, "SELECT count(*) FROM plans WHERE patient = ?");
  if (!count.bind(patient).next()) return count.status();
  if (count.integer(0) < kMaxPlansOfPatient) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(patient_name(patient), " has ", count.integer(0),
                                                    " plans, the bound is ", kMaxPlansOfPatient,
                                                    "; delete some first"));
}

absl::Status check_scans_of(Database& database, const PlanRecord& plan) {
  for (const std::string& id : {plan.scan, plan.target}) {
    if (id.empty()) continue;
    Query query(database, "SELECT 1 FROM scans WHERE patient = ? AND id = ?");
    if (query.bind(plan.patient, id).next()) continue;
    if (!query.status().ok()) return query.status();
    return absl::NotFoundError(absl::StrCat("there is no ", scan_name(plan.patient, id)));
  }
  return absl::OkStatus();
}

absl::Status write_plan_revision(Database& database, const PlanRecord& plan) {
  Query insert(database, "INSERT INTO plan_revisions (" PLAN_REVISION_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?)");
  absl::Status done =
      insert.bind(plan.patient, plan.id, plan.revision, plan.content_message, plan.changes_message, plan.update_time_us)
          .run();
  // The bytes are summed from the newest on.
  Query prune(database, R"(
      DELETE FROM plan_revisions WHERE patient = ?1 AND plan = ?2 AND number < ?3 AND (number <= ?3 - ?4 OR number IN (
        SELECT number FROM (
          SELECT number, sum(length(content)) OVER (ORDER BY number DESC) AS total
          FROM plan_revisions WHERE patient = ?1 AND plan = ?2) AS revisions WHERE total > ?5)))");
  done.Update(prune.bind(plan.patient, plan.id, plan.revision, kMaxPlanRevisions, kMaxPlanRevisionBytes).run());
  return done;
}

PlanRecord listed_plan_of(const Query& row) {
  if (row.is_true(8)) return plan_of(row);
  PlanRecord damaged;
  damaged.patient = row.text(0);
  damaged.id = row.text(1);
  damaged.is_damaged = true;
  return damaged;
}

}  // namespace lipofill::server
