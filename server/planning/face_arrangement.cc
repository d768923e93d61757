#include "server/planning/face_arrangement.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/planning/plan_parts.h"
#include "server/backend/size_limits.h"
#include "server/planning/face_merging.h"
#include "server/wire/names.h"
#include "server/wire/simulation_conversion.h"
#include "server/wire/violation_prefix.h"

namespace lipofill::server {
namespace {

constexpr int kMaxParts = 16;

/// A part and where it is.
struct PlacedPart {
  ModelledPart part;
  planning::PartPlace place;
};

absl::Status check_request(Backend& backend, const v1::ArrangeFaceRequest& request) {
  FieldViolations violations;
  violations.check_range("parts", request.parts_size(), 1, kMaxParts, "");
  std::set<std::string> names;
  std::string patient;
  for (int k = 0; k < request.parts_size(); ++k) {
    const v1::FacePart& part = request.parts(k);
    const std::string field = absl::StrCat("parts[", k, "]");
    if (!is_id(part.name())) {
      violations.add(field + ".name", absl::StrCat("is '", part.name(),
                                                   "', must be a letter and then up to 62 of a-z, "
                                                   "0-9 and -"));
    } else if (!names.insert(part.name()).second) {
      violations.add(field + ".name", absl::StrCat("is '", part.name(), "' again"));
    }
    const auto model = parse_model_name(part.plan().model(), field + ".plan.model");
    violations.absorb("", model.status());
    if (!model.ok()) continue;
    if (!patient.empty() && model->patient != patient) {
      violations.add(field + ".plan.model", "is of another patient than that of the first part");
    }
    patient = patient.empty() ? model->patient : patient;
  }
  if (!violations.empty()) return violations.to_status();
  for (const v1::FacePart& part : request.parts()) {
    if (absl::Status small = check_size(part.plan(), backend.options.sizes); !small.ok()) return small;
  }
  return absl::OkStatus();
}

absl::StatusOr<PlacedPart> place_part(Backend& backend, const v1::FacePart& message) {
  PlacedPart placed;
  placed.part.name = message.name();
  placed.part.plan = message.plan();
  const auto name = parse_model_name(message.plan().model(), "");
  if (!name.ok()) return name.status();
  const auto record = backend.store.get_model(name->patient, name->id);
  if (!record.ok()) return record.status();
  placed.part.model.ParseFromString(record->spec_message);
  const auto model = backend.load_model(message.plan().model());
  if (!model.ok()) return model.status();
  const auto plan = to_simulation_spec(message.plan());
  if (!plan.ok()) return plan.status();
  auto place = planning::place_part(**model, *plan);
  if (!place.ok()) return place.status();
  placed.place = *std::move(place);
  return placed;
}

/// Tells of parts that are simulated apart, though their models have skin in common.
void tell_of_margins(const std::vector<PlacedPart>& parts, const std::vector<size_t>& group,
                     v1::FaceArrangement& arrangement) {
  for (size_t b = 0; b < parts.size(); ++b) {
    for (size_t a = 0; a < b; ++a) {
      const int shared = planning::count_shared_vertices(parts[a].place, parts[b].place);
      if (group[a] == group[b] || shared == 0) continue;
      arrangement.add_remarks(absl::StrFormat(
          "The models of '%s' and '%s' share %d vertices of the scan, and their zones are %.0f mm apart: they are "
          "simulated apart, and what each does to that skin is added up.",
          parts[a].part.name, parts[b].part.name, shared,
          planning::find_distance(parts[a].place, parts[b].place) * kMillimetresPerMetre));
    }
  }
}

absl::StatusOr<v1::ArrangedPart> arrange_group(const std::vector<const PlacedPart*>& group) {
  v1::ArrangedPart arranged;
  std::vector<ModelledPart> parts;
  std::vector<planning::PartPlace> places;
  for (const PlacedPart* placed : group) {
    arranged.add_of(placed->part.name);
    parts.push_back(placed->part);
    places.push_back(placed->place);
  }
  if (parts.size() == 1) {
    arranged.set_name(parts[0].name);
    *arranged.mutable_plan() = parts[0].plan;
    return arranged;
  }
  auto merged = merge_parts(parts);
  if (!merged.ok()) return merged.status();
  arranged.set_name(merged->name);
  *arranged.mutable_plan() = std::move(merged->plan);
  *arranged.mutable_model_spec() = std::move(merged->model);
  arranged.set_distance_mm(planning::find_widest_gap(places) * kMillimetresPerMetre);
  return arranged;
}

}  // namespace

absl::StatusOr<v1::FaceArrangement> arrange_face(Backend& backend, const v1::ArrangeFaceRequest& request,
                                                 const Unwanted& unwanted) {
  if (absl::Status good = check_request(backend, request); !good.ok()) return good;
  std::vector<PlacedPart> parts;
  for (int k = 0; k < request.parts_size(); ++k) {
    auto placed = place_part(backend, request.parts(k));
    if (!placed.ok()) return with_prefix(absl::StrCat("parts[", k, "].plan"), placed.status());
    if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    parts.push_back(*std::move(placed));
    const std::string& scan = parts.back().part.model.scan_region().scan();
    if (scan.empty() || scan != parts.front().part.model.scan_region().scan()) {
      return field_violation(
          absl::StrCat("parts[", k, "].plan.model"),
          scan.empty() ? "is a plate, not a part of a face" : "is of another scan than that of the first part");
    }
  }
  std::vector<planning::PartPlace> places;
  for (const PlacedPart& part : parts) places.push_back(part.place);
  const std::vector<size_t> group_of = planning::group_touching(places);
  v1::FaceArrangement arrangement;
  for (size_t first = 0; first < parts.size(); ++first) {
    std::vector<const PlacedPart*> group;
    for (size_t k = first; k < parts.size(); ++k) {
      if (group_of[k] == first) group.push_back(&parts[k]);
    }
    if (group.empty()) continue;
    auto arranged = arrange_group(group);
    if (!arranged.ok()) return arranged.status();
    *arrangement.add_parts() = *std::move(arranged);
  }
  tell_of_margins(parts, group_of, arrangement);
  return arrangement;
}

}  // namespace lipofill::server
