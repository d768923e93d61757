#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "lipofill/v1/plan_service.pb.h"
#include "server/backend/backend.h"
#include "server/store/plan_records.h"

namespace lipofill::server {

/// Takes what a plan keeps of what its users gave: the message without what is the daemon's.
v1::SavedPlan kept_part(const v1::SavedPlan& given);

/// Checks what a plan is to keep: every resource that it names is of its patient, its landmarks are
/// of its scan, it names no files and is not too large. Violations have `field` before their paths.
absl::Status check_saved_plan(const v1::SavedPlan& plan, const std::string& patient, const std::string& field);

/// Refuses another scan with the landmarks of the one before: INVALID_ARGUMENT.
absl::Status check_landmarks_follow(const v1::SavedPlan& before, const v1::SavedPlan& after, const std::string& field);

/// Tells the scan and the content that a simulation depends on; names and descriptions do not
/// count.
std::string content_hash_of(const v1::SavedPlan& plan);

/// Etag of a plan: its revision, and its content.
std::string make_etag(const PlanRecord& plan);
/// The revision that an etag is of; 0 for what is none.
uint64_t revision_of_etag(const std::string& etag);

/// Reads what a record keeps. DATA_LOSS for what is no plan.
absl::StatusOr<v1::SavedPlan> parse_kept(const std::string& content_message, const std::string& name);

/// The resource as it is answered, without its runs.
absl::StatusOr<v1::SavedPlan> to_saved_plan(const PlanRecord& record);

/// Puts what is to be kept into a record; `before` is what it keeps now, if anything, from which
/// the changes are told.
void keep(const v1::SavedPlan& plan, const v1::SavedPlan* before, PlanRecord& record);

/// The changes as the record tells them.
v1::PlanRevision to_revision(const PlanRevisionRecord& record);

}  // namespace lipofill::server
