#pragma once

#include "absl/status/statusor.h"
#include "lipofill/v1/plan_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

/// Each of these answers one call on plans, once it was admitted.
absl::StatusOr<v1::SavedPlan> create_plan(Backend& backend, const Principal& caller,
                                          const v1::CreatePlanRequest& request);
absl::StatusOr<v1::SavedPlan> get_plan(Backend& backend, const std::string& name);
absl::StatusOr<v1::ListPlansResponse> list_plans(Backend& backend, const Principal& caller,
                                                 const v1::ListPlansRequest& request);
absl::StatusOr<v1::SavedPlan> update_plan(Backend& backend, const v1::UpdatePlanRequest& request);
absl::Status delete_plan(Backend& backend, const v1::DeletePlanRequest& request);
absl::StatusOr<v1::SavedPlan> add_plan_run(Backend& backend, const v1::AddPlanRunRequest& request);
absl::StatusOr<v1::ListPlanRevisionsResponse> list_plan_revisions(Backend& backend,
                                                                  const v1::ListPlanRevisionsRequest& request);
absl::StatusOr<v1::SavedPlan> get_plan_revision(Backend& backend, const v1::GetPlanRevisionRequest& request);

}  // namespace lipofill::server
