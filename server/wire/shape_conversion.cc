#include "server/wire/shape_conversion.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "server/wire/frame_encoding.h"
#include "server/wire/names.h"
#include "server/wire/report_conversion.h"

namespace lipofill::server {
namespace {

/// A sensitivity to a layer is told for so much more of its modulus or thickness.
constexpr double kLayerShare = 0.01;

/// A unit of the parameter, as people count it, in that of the core.
double unit_of(simulation::ShapeParameter parameter) {
  return parameter == simulation::ShapeParameter::kPoolVolume ? kCubicMetresPerMillilitre : kLayerShare;
}

SessionView view_of(const FoundTrial& found) {
  const simulation::Simulation& shape = found.shape.shape();
  SessionView view;
  view.state = SimulationState::kSettled;
  view.report = shape.report();
  view.zones = shape.zone_reports();
  view.ligaments = shape.ligament_reports();
  view.remarks = shape.remarks();
  view.layers = shape.layer_reports();
  view.n_hexahedra = shape.n_hexahedra();
  view.n_film_cells = shape.n_film_cells();
  view.n_dofs = shape.n_dofs();
  if (found.shape.is_from_rest()) view.state_hash = shape.state_hash();
  return view;
}

v1::ShapeSensitivity::Parameter to_parameter(simulation::ShapeParameter parameter) {
  switch (parameter) {
    case simulation::ShapeParameter::kPoolVolume:
      return v1::ShapeSensitivity::POOL_VOLUME;
    case simulation::ShapeParameter::kLayerModulus:
      return v1::ShapeSensitivity::LAYER_STIFFNESS;
    case simulation::ShapeParameter::kLayerThickness:
      return v1::ShapeSensitivity::LAYER_THICKNESS;
  }
  return v1::ShapeSensitivity::PARAMETER_UNSPECIFIED;
}

void add_sensitivity(const simulation::ShapeSensitivity& from, v1::FoundShape& shape) {
  v1::ShapeSensitivity& to = *shape.add_sensitivities();
  const double unit = unit_of(from.parameter);
  to.set_parameter(to_parameter(from.parameter));
  to.set_name(from.name);
  to.set_max_displacement_mm(unit * from.skin.colwise().norm().maxCoeff() * kMillimetresPerMetre);
  to.set_skin_volume_ml(unit * from.skin_volume / kCubicMetresPerMillilitre);
  for (const double pressure : from.pool_pressure) to.add_pressure_pa(unit * pressure);
}

v1::FoundShape to_found_shape(const FoundTrial& found, const std::vector<simulation::ShapeSensitivity>& sensitivities) {
  v1::FoundShape shape;
  *shape.mutable_summary() = to_summary(view_of(found));
  shape.set_volume_share(found.shape.share());
  shape.set_reason(found.shape.reason());
  shape.set_from_rest(found.shape.is_from_rest());
  shape.set_finding_ms(found.finding_s * kMillisecondsPerSecond);
  shape.set_preparing_ms(found.preparing_s * kMillisecondsPerSecond);
  shape.set_superseded(found.superseded);
  for (const simulation::PoolReport& pool : found.shape.pools()) {
    v1::FatPool& to = *shape.add_pools();
    to.set_zones(pool.zones);
    to.set_volume_ml(pool.volume / kCubicMetresPerMillilitre);
    to.set_pressure_pa(pool.head);
  }
  for (const simulation::ShapeSensitivity& sensitivity : sensitivities) add_sensitivity(sensitivity, shape);
  return shape;
}

simulation::FrameField to_field(const simulation::ShapeSensitivity& sensitivity, size_t place) {
  simulation::FrameField field{"skin", absl::StrCat("sensitivity/", place), "mm", simulation::FieldLocation::kPoint, 3,
                               {}};
  const double scale = unit_of(sensitivity.parameter) * kMillimetresPerMetre;
  field.values.reserve(static_cast<size_t>(sensitivity.skin.size()));
  for (const double value : sensitivity.skin.reshaped()) field.values.push_back(static_cast<float>(scale * value));
  return field;
}

absl::Status check_fields(const v1::FindShapeRequest& request, const std::vector<std::string>& known) {
  FieldViolations violations;
  for (int i = 0; i < request.fields_size(); ++i) {
    if (std::find(known.begin(), known.end(), request.fields(i)) != known.end()) continue;
    violations.add(absl::StrCat("fields[", i, "]"),
                   absl::StrCat("is \"", request.fields(i), "\", there are ", absl::StrJoin(known, ", ")));
  }
  return violations.empty() ? absl::OkStatus() : violations.to_status();
}

}  // namespace

absl::StatusOr<simulation::TrialVolumes> to_trial_volumes(const v1::FindShapeRequest& request) {
  FieldViolations violations;
  if (request.plan_case() == v1::FindShapeRequest::PLAN_NOT_SET) {
    violations.add("spec", "is missing, and simulation as well: one of them says the plan");
  }
  if (!request.drag().empty()) violations.absorb("", id_or_new(request.drag(), 'd', "drag").status());
  check_field_type(request.field_type(), violations);
  if (!violations.empty()) return violations.to_status();
  simulation::TrialVolumes volumes;
  for (const v1::InjectionVolume& injection : request.injections()) {
    volumes.injections.push_back({injection.index(), injection.volume_ml() * kCubicMetresPerMillilitre});
  }
  for (const v1::AddedFat& added : request.added()) {
    volumes.added.push_back({added.zone(), added.volume_ml() * kCubicMetresPerMillilitre});
  }
  return volumes;
}

absl::StatusOr<std::vector<v1::FindShapeResponse>> to_find_shape_responses(
    const v1::FindShapeRequest& request, const FoundTrial& found,
    const std::vector<simulation::ShapeSensitivity>& sensitivities) {
  Frame frame;
  frame.time_s = found.shape.shape().report().time;
  frame.fields = found.shape.shape().frame({"skin", "scan"});
  if (absl::Status known = check_fields(request, frame.field_names()); !known.ok()) return known;
  Selection selection{{"skin", "scan"}, {request.fields().begin(), request.fields().end()}};
  if (selection.fields.empty()) selection.fields = {"skin.displacement", "skin.pressure"};
  selection.quantised = request.field_type() == v1::UINT16;
  for (size_t k = 0; k < sensitivities.size(); ++k) {
    frame.fields.push_back(to_field(sensitivities[k], k));
    selection.fields.push_back(absl::StrCat("skin.", frame.fields.back().name));
  }
  std::vector<v1::FindShapeResponse> responses(1);
  *responses[0].mutable_shape() = to_found_shape(found, sensitivities);
  for (std::vector<v1::ArraySlice>& arrays : slice_arrays(to_whole_frame(frame, selection).fields())) {
    v1::FrameSlice& slice = *responses.emplace_back().mutable_frame();
    slice.set_time_s(frame.time_s);
    for (v1::ArraySlice& array : arrays) *slice.add_fields() = std::move(array);
  }
  responses.back().mutable_frame()->set_last(true);
  return responses;
}

}  // namespace lipofill::server
