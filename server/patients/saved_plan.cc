#include "server/patients/saved_plan.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/base/hash.h"
#include "server/store/record_names.h"
#include "server/wire/message_changes.h"
#include "server/wire/names.h"
#include "server/wire/request_key.h"
#include "server/wire/resource_names.h"
#include "server/wire/timestamps.h"

namespace lipofill::server {
namespace {

constexpr size_t kMaxPlanBytes = size_t{1} << 20;
constexpr size_t kMaxChanges = 20;
constexpr size_t kHashDigits = 16;

std::string shorten(Hasher& hasher) {
  return hasher.hex_digest().substr(0, kHashDigits);
}

/// The id of a scan of the patient; empty for none.
void check_scan(const std::string& name, const std::string& patient, const std::string& field,
                FieldViolations& violations) {
  if (name.empty()) return;
  const auto scan = parse_scan_name(name, field);
  violations.absorb("", scan.status());
  if (scan.ok() && scan->patient != patient) {
    violations.add(field,
                   absl::StrCat("is ", name, ", must be a scan of ", patient_name(patient), ", whose plan it is"));
  }
}

/// Whatever the content names, wherever it does.
void check_names(const v1::SavedPlan& plan, const std::string& patient, const std::string& field,
                 FieldViolations& violations) {
  for (const std::string& other : resource_names_in(plan.content()).patients) {
    if (other == patient) continue;
    violations.add(field + ".content",
                   absl::StrCat("names ", patient_name(other), ", must name nothing but what is of ",
                                patient_name(patient), ", whose plan it is"));
  }
}

void check_region(const v1::SavedPlan& plan, const std::string& field, FieldViolations& violations) {
  const v1::ScanRegion& region = plan.content().model().scan_region();
  if (!region.scan().empty() && region.scan() != plan.scan()) {
    violations.add(field + ".content.model.scan_region.scan",
                   absl::StrCat("is ", region.scan(), ", must be the scan that the plan is for: ",
                                plan.scan().empty() ? "none" : plan.scan()));
  }
  if (!region.landmarks_mm().empty() && plan.scan().empty()) {
    violations.add(field + ".content.model.scan_region.landmarks_mm",
                   "are given, must be absent without the scan that they are of");
  }
}

void check_files(const v1::SavedPlan& plan, const std::string& field, FieldViolations& violations) {
  const auto refuse = [&](bool is_given, const char* part) {
    if (is_given) {
      violations.add(absl::StrCat(field, ".content.", part),
                     "is given, must be absent: a plan that is kept names its scan by `scan`, and files not at all");
    }
  };
  refuse(plan.content().has_scan(), "scan");
  refuse(plan.content().has_bone(), "bone");
}

std::string id_of_scan(const std::string& name) {
  const auto ids = parse_scan_name(name, "scan");
  return ids.ok() ? ids->id : "";
}

}  // namespace

v1::SavedPlan kept_part(const v1::SavedPlan& given) {
  v1::SavedPlan kept;
  kept.set_title(given.title());
  kept.set_side(given.side());
  kept.set_scan(given.scan());
  kept.set_target_scan(given.target_scan());
  if (given.has_content()) *kept.mutable_content() = given.content();
  return kept;
}

absl::Status check_saved_plan(const v1::SavedPlan& plan, const std::string& patient, const std::string& field) {
  FieldViolations violations;
  violations.absorb("", check_display_name(plan.title(), field + ".title"));
  check_scan(plan.scan(), patient, field + ".scan", violations);
  check_scan(plan.target_scan(), patient, field + ".target_scan", violations);
  check_names(plan, patient, field, violations);
  check_region(plan, field, violations);
  check_files(plan, field, violations);
  if (const size_t bytes = plan.ByteSizeLong(); bytes > kMaxPlanBytes) {
    violations.add(field + ".content", absl::StrCat("has ", bytes, " bytes, must have at most ", kMaxPlanBytes));
  }
  return violations.to_status();
}

absl::Status check_landmarks_follow(const v1::SavedPlan& before, const v1::SavedPlan& after, const std::string& field) {
  if (before.scan().empty() || after.scan() == before.scan()) return absl::OkStatus();
  const auto& had = before.content().model().scan_region().landmarks_mm();
  const auto& has = after.content().model().scan_region().landmarks_mm();
  for (const auto& [name, position] : has) {
    const auto found = had.find(name);
    if (found == had.end()) continue;
    if (serialize_in_order(found->second) != serialize_in_order(position)) continue;
    return field_violation(absl::StrCat(field, ".content.model.scan_region.landmarks_mm[", name, "]"),
                           absl::StrCat("is where it was on ", before.scan(), ", must be placed on ", after.scan()));
  }
  return absl::OkStatus();
}

std::string content_hash_of(const v1::SavedPlan& plan) {
  v1::Plan content = plan.content();
  content.clear_name();
  content.clear_description();
  content.clear_output();
  Hasher hasher;
  hasher.add(plan.scan());
  hasher.add(serialize_in_order(content));
  return shorten(hasher);
}

std::string make_etag(const PlanRecord& plan) {
  Hasher hasher;
  hasher.add(plan.content_message);
  return absl::StrCat(plan.revision, "-", shorten(hasher));
}

uint64_t revision_of_etag(const std::string& etag) {
  uint64_t revision = 0;
  return absl::SimpleAtoi(etag.substr(0, etag.find('-')), &revision) ? revision : 0;
}

absl::StatusOr<v1::SavedPlan> parse_kept(const std::string& content_message, const std::string& name) {
  v1::SavedPlan plan;
  if (plan.ParseFromString(content_message)) return plan;
  return absl::DataLossError(absl::StrCat(name, " is damaged: what is kept of it is no plan"));
}

absl::StatusOr<v1::SavedPlan> to_saved_plan(const PlanRecord& record) {
  auto plan = parse_kept(record.content_message, plan_name(record.patient, record.id));
  if (!plan.ok()) return plan;
  plan->set_content_hash(content_hash_of(*plan));
  plan->set_name(plan_name(record.patient, record.id));
  plan->set_revision(record.revision);
  plan->set_etag(make_etag(record));
  *plan->mutable_create_time() = to_timestamp(record.create_time_us);
  *plan->mutable_update_time() = to_timestamp(record.update_time_us);
  return plan;
}

void keep(const v1::SavedPlan& plan, const v1::SavedPlan* before, PlanRecord& record) {
  record.scan = id_of_scan(plan.scan());
  record.target = id_of_scan(plan.target_scan());
  record.content_message = serialize_in_order(plan);
  v1::PlanRevision told;
  told.set_title(plan.title());
  if (before != nullptr) {
    for (const FieldViolation& change : changes_between(*before, plan, kMaxChanges)) {
      told.add_changes(absl::StrCat(change.field, " ", change.description));
    }
  }
  record.changes_message = told.SerializeAsString();
}

v1::PlanRevision to_revision(const PlanRevisionRecord& record) {
  v1::PlanRevision revision;
  revision.ParseFromString(record.changes_message);
  revision.set_revision(record.number);
  *revision.mutable_create_time() = to_timestamp(record.create_time_us);
  revision.set_size_bytes(record.content_message.size());
  return revision;
}

}  // namespace lipofill::server
