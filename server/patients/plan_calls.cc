#include "server/patients/plan_calls.h"

#include <algorithm>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "core/base/field_violations.h"
#include "server/entry/listing.h"
#include "server/patients/saved_plan.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/wire/etag.h"
#include "server/wire/field_mask.h"
#include "server/wire/message_changes.h"
#include "server/wire/names.h"
#include "server/wire/request_key.h"
#include "server/wire/timestamps.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr uint64_t kMaxListedBytes = uint64_t{2} << 20;
constexpr size_t kMaxConflicts = 20;
constexpr char kEveryPatient[] = "patients/-";

absl::StatusOr<v1::SavedPlan> with_runs(Backend& backend, const PlanRecord& record) {
  auto plan = to_saved_plan(record);
  if (!plan.ok()) return plan;
  const auto runs = backend.store.list_plan_runs(record.patient, record.id);
  if (!runs.ok()) return runs.status();
  for (const PlanRunRecord& run : *runs) {
    v1::PlanRun& told = *plan->add_runs();
    told.set_simulation(simulation_name(run.simulation));
    told.set_content_hash(run.content_hash);
    *told.mutable_create_time() = to_timestamp(run.create_time_us);
  }
  return plan;
}

absl::StatusOr<v1::SavedPlan> with_runs(Backend& backend, const absl::StatusOr<PlanRecord>& record) {
  if (!record.ok()) return record.status();
  return with_runs(backend, *record);
}

absl::Status check_update_mask(const v1::UpdatePlanRequest& request) {
  if (auto good = check_field_mask(request.update_mask(), *v1::SavedPlan::descriptor(), "update_mask"); !good.ok()) {
    return good;
  }
  for (const std::string& path : request.update_mask().paths()) {
    const bool may_change = path == "title" || path == "side" || path == "scan" || path == "target_scan" ||
                            path == "content" || path == "*";
    if (may_change) continue;
    return field_violation(
        "update_mask", absl::StrCat("names ", path, "; only title, side, scan, target_scan and content can change"));
  }
  return absl::OkStatus();
}

/// Makes what the plan keeps after an update.
v1::SavedPlan updated(const v1::SavedPlan& present, const v1::UpdatePlanRequest& request) {
  v1::SavedPlan plan = present;
  const v1::SavedPlan given = kept_part(request.plan());
  const auto& mask = request.update_mask();
  if (is_masked(mask, "title")) plan.set_title(given.title());
  if (is_masked(mask, "side")) plan.set_side(given.side());
  if (is_masked(mask, "scan")) plan.set_scan(given.scan());
  if (is_masked(mask, "target_scan")) plan.set_target_scan(given.target_scan());
  if (is_masked(mask, "content")) {
    plan.clear_content();
    if (given.has_content()) *plan.mutable_content() = given.content();
  }
  return plan;
}

/// Says what somebody else changed since the etag was read, and when.
absl::Status explain_conflict(Backend& backend, const PatientChild& ids, const std::string& etag) {
  const auto record = backend.store.get_plan(ids.patient, ids.id);
  if (!record.ok()) return record.status();
  const std::string when =
      absl::FormatTime(absl::RFC3339_sec, absl::FromUnixMicros(record->update_time_us), absl::UTCTimeZone());
  FieldViolations changes;
  changes.add("plan.etag", absl::StrCat("is \"", etag.substr(0, 64), "\", the present one is \"", make_etag(*record),
                                        "\": it was changed at ", when, "; read it again"));
  const auto present = parse_kept(record->content_message, plan_name(ids.patient, ids.id));
  const auto read = backend.store.get_plan_revision(ids.patient, ids.id, revision_of_etag(etag));
  if (present.ok() && read.ok()) {
    if (const auto before = parse_kept(read->content_message, plan_name(ids.patient, ids.id)); before.ok()) {
      for (const FieldViolation& change : changes_between(*before, *present, kMaxConflicts)) {
        changes.add(absl::StrCat("plan.", change.field), change.description);
      }
    }
  }
  const absl::Status all = changes.to_status();
  absl::Status conflict(absl::StatusCode::kAborted, all.message());
  all.ForEachPayload(
      [&conflict](absl::string_view type, const absl::Cord& payload) { conflict.SetPayload(type, payload); });
  return conflict;
}

}  // namespace

absl::StatusOr<v1::SavedPlan> create_plan(Backend& backend, const Principal& caller,
                                          const v1::CreatePlanRequest& request) {
  FieldViolations violations;
  violations.absorb("", check_request_id(request.request_id()));
  const auto patient = parse_patient_name(request.parent(), "parent");
  violations.absorb("", patient.status());
  const auto id = id_or_new(request.plan_id(), 'q', "plan_id");
  violations.absorb("", id.status());
  const v1::SavedPlan plan = kept_part(request.plan());
  if (patient.ok()) violations.absorb("", check_saved_plan(plan, *patient, "plan"));
  if (!violations.empty()) return violations.to_status();
  PlanRecord draft;
  draft.patient = *patient;
  draft.id = *id;
  draft.create_time_us = draft.update_time_us = now_us();
  keep(plan, nullptr, draft);
  if (request.validate_only()) {
    if (const auto known = backend.store.get_patient(*patient); !known.ok()) return known.status();
    if (backend.store.get_plan(*patient, *id).ok()) {
      return absl::AlreadyExistsError(plan_name(*patient, *id) + " exists");
    }
    return to_saved_plan(draft);
  }
  const auto made =
      backend.store.create_plan(draft, make_request_key(caller, "CreatePlan", request.request_id(), request));
  if (made.ok()) spdlog::info("{} created", plan_name(made->patient, made->id));
  return with_runs(backend, made);
}

absl::StatusOr<v1::SavedPlan> get_plan(Backend& backend, const std::string& name) {
  const auto ids = parse_plan_name(name, "name");
  if (!ids.ok()) return ids.status();
  return with_runs(backend, backend.store.get_plan(ids->patient, ids->id));
}

absl::StatusOr<v1::ListPlansResponse> list_plans(Backend& backend, const Principal& caller,
                                                 const v1::ListPlansRequest& request) {
  const bool is_of_all = request.parent() == kEveryPatient;
  const auto patient = is_of_all ? std::string() : parse_patient_name(request.parent(), "parent");
  if (!patient.ok()) return patient.status();
  const auto& mask = request.read_mask();
  if (auto good = check_field_mask(mask, *v1::SavedPlan::descriptor(), "read_mask"); !good.ok()) return good;
  const std::string collection = request.parent() + "/plans";
  const auto page = parse_page(collection, request.page_size(), request.page_token());
  if (!page.ok()) return page.status();
  const auto plans = backend.store.list_plans(caller.scope, *patient, one_more(*page), kMaxListedBytes);
  if (!plans.ok()) return plans.status();

  v1::ListPlansResponse response;
  uint64_t read_bytes = 0;
  uint64_t told_bytes = 0;
  size_t n = 0;
  for (; n < plans->size() && n < static_cast<size_t>(page->size) && told_bytes < kMaxListedBytes; ++n) {
    const PlanRecord& record = (*plans)[n];
    read_bytes += record.content_message.size();
    auto plan = record.is_damaged ? absl::DataLossError("") : with_runs(backend, record);
    if (absl::IsDataLoss(plan.status())) {
      add_unreachable(plan_name(record.patient, record.id), response);
      continue;
    }
    if (!plan.ok()) return plan.status();
    apply_field_mask(mask, *plan);
    told_bytes += plan->ByteSizeLong();
    *response.add_plans() = *std::move(plan);
  }
  // The store stops where it has read that much; what comes after is on the next page.
  const bool is_last = n == plans->size() && read_bytes <= kMaxListedBytes;
  if (!is_last) {
    const PlanRecord& last = (*plans)[n - 1];
    response.set_next_page_token(make_page_token(collection, absl::StrCat(last.patient, "/", last.id)));
  }
  return response;
}

absl::StatusOr<v1::SavedPlan> update_plan(Backend& backend, const v1::UpdatePlanRequest& request) {
  FieldViolations violations;
  const v1::SavedPlan& given = request.plan();
  const auto ids = parse_plan_name(given.name(), "plan.name");
  violations.absorb("", ids.status());
  violations.absorb("", check_update_mask(request));
  if (!violations.empty()) return violations.to_status();

  const auto change = [&](const PlanRecord& present) -> absl::StatusOr<PlanRecord> {
    const auto before = parse_kept(present.content_message, given.name());
    if (!before.ok()) return before.status();
    const v1::SavedPlan after = updated(*before, request);
    if (auto good = check_saved_plan(after, ids->patient, "plan"); !good.ok()) return good;
    PlanRecord changed = present;
    keep(after, &*before, changed);
    if (changed.content_message == present.content_message) return present;
    if (auto fits = check_etag(given.etag(), make_etag(present), "plan.etag"); !fits.ok()) return fits;
    if (auto follow = check_landmarks_follow(*before, after, "plan"); !follow.ok()) return follow;
    changed.update_time_us = now_us();
    return changed;
  };
  auto updated = backend.store.get_plan(ids->patient, ids->id);
  if (updated.ok()) {
    updated = request.validate_only() ? change(*updated) : backend.store.update_plan(ids->patient, ids->id, change);
  }
  if (absl::IsAborted(updated.status())) return explain_conflict(backend, *ids, given.etag());
  return with_runs(backend, updated);
}

absl::Status delete_plan(Backend& backend, const v1::DeletePlanRequest& request) {
  const auto ids = parse_plan_name(request.name(), "name");
  if (!ids.ok()) return ids.status();
  PlanStore::PlanCheck check;
  if (!request.etag().empty()) {
    check = [&request](const PlanRecord& present) { return check_etag(request.etag(), make_etag(present), "etag"); };
  }
  const absl::Status done =
      backend.reserve.spend([&] { return backend.store.delete_plan(ids->patient, ids->id, check); });
  if (done.ok()) spdlog::info("{} deleted", request.name());
  return done;
}

absl::StatusOr<v1::SavedPlan> add_plan_run(Backend& backend, const v1::AddPlanRunRequest& request) {
  FieldViolations violations;
  const auto ids = parse_plan_name(request.name(), "name");
  violations.absorb("", ids.status());
  const auto simulation = parse_simulation_name(request.simulation(), "simulation");
  violations.absorb("", simulation.status());
  violations.absorb("", check_display_name(request.content_hash(), "content_hash"));
  if (!violations.empty()) return violations.to_status();
  const auto plan = backend.store.get_plan(ids->patient, ids->id);
  if (!plan.ok()) return plan.status();
  const auto owner = backend.store.owner_of_simulation(*simulation);
  if (!owner.ok()) return owner.status();
  if (owner->patient != ids->patient) {
    return field_violation("simulation", absl::StrCat("is ", request.simulation(), ", must be a simulation of ",
                                                      patient_name(ids->patient), ", whose plan it is"));
  }
  PlanRunRecord run{*simulation, request.content_hash(), now_us()};
  if (run.content_hash.empty()) {
    const auto kept = parse_kept(plan->content_message, request.name());
    if (!kept.ok()) return kept.status();
    run.content_hash = content_hash_of(*kept);
  }
  if (auto added = backend.store.add_plan_run(ids->patient, ids->id, run); !added.ok()) return added;
  return with_runs(backend, backend.store.get_plan(ids->patient, ids->id));
}

absl::StatusOr<v1::ListPlanRevisionsResponse> list_plan_revisions(Backend& backend,
                                                                  const v1::ListPlanRevisionsRequest& request) {
  const auto ids = parse_plan_name(request.parent(), "parent");
  if (!ids.ok()) return ids.status();
  const std::string collection = request.parent() + "/revisions";
  const auto page = parse_page(collection, request.page_size(), request.page_token());
  if (!page.ok()) return page.status();
  const auto revisions = backend.store.list_plan_revisions(ids->patient, ids->id);
  if (!revisions.ok()) return revisions.status();
  uint64_t after = 0;  // a page begins after this one, the newest come first
  const bool is_first_page = !absl::SimpleAtoi(page->after, &after);
  v1::ListPlanRevisionsResponse response;
  for (const PlanRevisionRecord& revision : *revisions) {
    if (!is_first_page && revision.number >= after) continue;
    if (response.revisions_size() == page->size) {
      response.set_next_page_token(
          make_page_token(collection, absl::StrCat(response.revisions(response.revisions_size() - 1).revision())));
      break;
    }
    *response.add_revisions() = to_revision(revision);
  }
  return response;
}

absl::StatusOr<v1::SavedPlan> get_plan_revision(Backend& backend, const v1::GetPlanRevisionRequest& request) {
  const auto ids = parse_plan_name(request.name(), "name");
  if (!ids.ok()) return ids.status();
  auto record = backend.store.get_plan(ids->patient, ids->id);
  if (!record.ok()) return record.status();
  const auto revision = backend.store.get_plan_revision(ids->patient, ids->id, request.revision());
  if (!revision.ok()) return revision.status();
  record->revision = revision->number;
  record->content_message = revision->content_message;
  record->update_time_us = revision->create_time_us;
  return to_saved_plan(*record);
}

}  // namespace lipofill::server
