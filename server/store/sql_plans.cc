#include <algorithm>

#include "absl/strings/str_cat.h"
#include "server/store/plan_rows.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/scope_query.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

#define PLAN_IS_WHOLE IS_WHOLE("plans", PLAN_COLUMNS)

absl::Status no_plan(const std::string& patient, const std::string& id) {
  return absl::NotFoundError(absl::StrCat("there is no ", plan_name(patient, id)));
}

}  // namespace

absl::StatusOr<PlanRecord> SqlStore::create_plan(const PlanRecord& plan, const RequestKey& request) {
  PlanRecord made = plan;
  made.revision = 1;
  made.update_time_us = made.create_time_us;
  const auto earlier = transact_once(request, plan_name(plan.patient, plan.id), [&]() -> absl::Status {
    if (const auto patient = read_patient(made.patient); !patient.ok()) return patient.status();
    absl::Status fits = check_plan_fits(*database_, made.patient);
    fits.Update(check_scans_of(*database_, made));
    if (!fits.ok()) return fits;
    Query insert(*database_, "INSERT INTO plans (" PLAN_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    absl::Status done = insert
                            .bind(made.patient, made.id, made.revision, made.scan, made.target, made.content_message,
                                  made.create_time_us, made.update_time_us)
                            .run();
    if (absl::IsAlreadyExists(done)) {
      return absl::AlreadyExistsError(absl::StrCat(plan_name(made.patient, made.id), " exists"));
    }
    done.Update(write_plan_revision(*database_, made));
    return done;
  });
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return get_plan(plan.patient, (**earlier).substr(plan_name(plan.patient, "").size()));
  return made;
}

absl::StatusOr<PlanRecord> SqlStore::get_plan(const std::string& patient, const std::string& id) {
  return turns_.look([&] { return read_plan(*database_, patient, id); });
}

absl::StatusOr<std::vector<PlanRecord>> SqlStore::list_plans(const Scope& scope, const std::string& patient,
                                                             const Page& page, uint64_t most_bytes) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<PlanRecord>> {
    if (!patient.empty()) {
      if (const auto known = read_patient(patient); !known.ok()) return known.status();
    }
    const size_t slash = std::min(page.after.find('/'), page.after.size());
    const std::string after_patient = page.after.substr(0, slash);
    const std::string after_id = page.after.substr(std::min(slash + 1, page.after.size()));
    Query query(
        *database_,
        "SELECT " PLAN_COLUMNS ", " PLAN_IS_WHOLE
        " FROM plans WHERE (patient, id) > (?1, ?2) AND (length(CAST(?3 AS BLOB)) = 0 OR patient = ?3) AND patient IN "
        "(SELECT id FROM patients WHERE tenant = ?4) AND " IS_AMONG("patient", "?5",
                                                                    "?6") " ORDER BY patient, id LIMIT ?7");
    query.bind(after_patient, after_id, patient, scope.tenant, !scope.patients, patients_of(scope), page.size);
    std::vector<PlanRecord> plans;
    for (uint64_t bytes = 0; bytes <= most_bytes && query.next();) {
      plans.push_back(listed_plan_of(query));
      bytes += plans.back().content_message.size();
    }
    if (!query.status().ok()) return query.status();
    return plans;
  });
}

absl::StatusOr<PlanRecord> SqlStore::update_plan(const std::string& patient, const std::string& id,
                                                 const PlanChange& change) {
  return turns_.transact([&]() -> absl::StatusOr<PlanRecord> {
    const auto present = read_plan(*database_, patient, id);
    if (!present.ok()) return present.status();
    auto plan = change(*present);
    if (!plan.ok()) return plan.status();
    if (plan->content_message == present->content_message) return present;
    if (const absl::Status there = check_scans_of(*database_, *plan); !there.ok()) return there;
    plan->revision = present->revision + 1;
    Query update(*database_,
                 "UPDATE plans SET revision = ?, scan = ?, target = ?, content = ?, update_time_us = ? "
                 "WHERE patient = ? AND id = ?");
    absl::Status done =
        update.bind(plan->revision, plan->scan, plan->target, plan->content_message, plan->update_time_us, patient, id)
            .run();
    if (done.ok()) done = write_plan_revision(*database_, *plan);
    if (!done.ok()) return done;
    return plan;
  });
}

absl::Status SqlStore::delete_plan(const std::string& patient, const std::string& id, const PlanCheck& check) {
  return turns_.transact([&]() -> absl::Status {
    if (check != nullptr) {
      const auto present = read_plan(*database_, patient, id);
      const absl::Status fits = present.ok() ? check(*present) : present.status();
      if (!fits.ok()) return fits;
    }
    Query remove(*database_, "DELETE FROM plans WHERE patient = ? AND id = ?");
    const absl::Status removed = remove.bind(patient, id).run();
    if (removed.ok() && database_->changes() == 0) return no_plan(patient, id);
    return removed.ok() ? forget_requests(plan_name(patient, id)) : removed;
  });
}

}  // namespace lipofill::server
