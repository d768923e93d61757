#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/plan_records.h"
#include "server/store/records.h"

namespace lipofill::server {

/// A plan keeps the newest revisions, at most so many, and no more bytes than these; the newest of
/// all it keeps always.
inline constexpr int kMaxPlanRevisions = 200;
inline constexpr int64_t kMaxPlanRevisionBytes = int64_t{16} << 20;
inline constexpr int kMaxPlansOfPatient = 1000;
inline constexpr int kMaxRunsOfPlan = 200;

/// The part of the store that keeps plans, their revisions, and what was run from them; as durable
/// and transactional as the rest. A plan goes with its patient, a run with its simulation.
///
/// Errors: as those of Store.
/// Checked by tests/unit/server/store/plans_test.cc.
class PlanStore {
 public:
  virtual ~PlanStore() = default;

  /// Returns the record now in the store: the one given, or the one an equal request made before.
  /// NOT_FOUND without its patient or a scan it names, FAILED_PRECONDITION where the patient has as
  /// many plans as it may.
  virtual absl::StatusOr<PlanRecord> create_plan(const PlanRecord& plan, const RequestKey& request) = 0;
  virtual absl::StatusOr<PlanRecord> get_plan(const std::string& patient, const std::string& id) = 0;
  /// Lists the plans of a patient, or of all patients within the scope where it is empty, by
  /// patient and id. The list ends with the plan whose message takes it past `most_bytes`. A page
  /// begins after "{patient}/{plan}".
  virtual absl::StatusOr<std::vector<PlanRecord>> list_plans(const Scope& scope, const std::string& patient,
                                                             const Page& page, uint64_t most_bytes) = 0;
  /// Replaces scan, target, content and changes by what `change` makes of the present record;
  /// nobody comes between. What `change` refuses is not done, and content that stays the same makes
  /// no revision.
  using PlanChange = std::function<absl::StatusOr<PlanRecord>(const PlanRecord& present)>;
  virtual absl::StatusOr<PlanRecord> update_plan(const std::string& patient, const std::string& id,
                                                 const PlanChange& change) = 0;
  /// Deletes a plan. `check`, if any, may refuse.
  using PlanCheck = std::function<absl::Status(const PlanRecord& present)>;
  virtual absl::Status delete_plan(const std::string& patient, const std::string& id,
                                   const PlanCheck& check = nullptr) = 0;

  /// The revisions that are kept, the newest first.
  virtual absl::StatusOr<std::vector<PlanRevisionRecord>> list_plan_revisions(const std::string& patient,
                                                                              const std::string& id) = 0;
  /// NOT_FOUND, naming those that are kept, for another one.
  virtual absl::StatusOr<PlanRevisionRecord> get_plan_revision(const std::string& patient, const std::string& id,
                                                               uint64_t number) = 0;

  /// Notes a simulation that is there; once more for the same plan replaces its hash.
  /// ALREADY_EXISTS for one of another plan.
  virtual absl::Status add_plan_run(const std::string& patient, const std::string& id, const PlanRunRecord& run) = 0;
  /// The newest runs of a plan, the newest first.
  virtual absl::StatusOr<std::vector<PlanRunRecord>> list_plan_runs(const std::string& patient,
                                                                    const std::string& id) = 0;
};

}  // namespace lipofill::server
