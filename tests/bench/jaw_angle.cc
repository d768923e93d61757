#include "tests/bench/jaw_angle.h"

#include <fstream>
#include <sstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cpp/plan_file.h"
#include "core/geometry/surface_reader.h"
#include "server/wire/model_conversion.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::bench {
namespace {

/// Fat with any has to be stepped [Pa].
constexpr double kNegligibleYieldStress = 1e-6;

/// The plan with what the daemon would have put there: the scan and the model are passed on as they
/// are.
absl::StatusOr<client::PlanFile> load_sample_plan() {
  auto plan = client::load_plan(LIPOFILL_EXAMPLES "/plans/jaw_angle.json");
  if (!plan.ok()) return plan;
  if (const absl::Status status = client::load_plan_landmarks(&*plan); !status.ok()) return status;
  plan->plan.mutable_model()->mutable_scan_region()->set_scan("patients/jaw/scans/face");
  plan->plan.mutable_simulation()->set_model("patients/jaw/models/face");
  return plan;
}

absl::StatusOr<geometry::SurfaceMesh> read_face(const client::PlanFile& plan) {
  std::ifstream file(*plan.scan_file, std::ios::binary);
  std::stringstream bytes;
  bytes << file.rdbuf();
  return geometry::read_surface(bytes.str(), geometry::SurfaceFormat::kObj, 1e-3);
}

/// As `lipofill run --fast` does.
void aim_at_settled_shape(v1::TimeControl& time) {
  time.set_goal(v1::TimeControl::SETTLED_SHAPE);
  time.clear_max_step_ms();
  time.clear_max_injection_step_ms();
  time.clear_error_tolerance_mm();
}

absl::Status refine(int scale, model::FaceModelSpec& model, plan::FilmSpec& film) {
  if (scale == kTinyScale) {
    model.n_xi /= 2;
    model.n_eta = 2 * (model.n_eta / 4) + 1;
    film.n_xi /= 2;
    film.n_eta /= 2;
    film.extent.eta_max = 2.0 * film.n_eta / model.n_eta;
    return absl::OkStatus();
  }
  for (int k = 1; k * k <= scale; k *= 2) {
    if (k * k != scale) continue;
    for (int* n : {&model.n_xi, &model.n_eta, &film.n_xi, &film.n_eta}) *n *= k;
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat("a scale of ", scale, ", must be 1, 4, 16 or 64"));
}

absl::StatusOr<JawAngle> build(int scale, SampleFace face) {
  auto model = model::build_face_model(face.model, nullptr);
  if (!model.ok()) return model.status();
  plan::SimulationSpec in_steps = face.settled_shape;
  in_steps.fat_yield_stress = kNegligibleYieldStress;
  return JawAngle{scale, *std::move(model), std::move(face.simulation), std::move(face.settled_shape),
                  std::move(in_steps)};
}

}  // namespace

absl::StatusOr<SampleFace> load_sample_face(int scale) {
  auto plan = load_sample_plan();
  if (!plan.ok()) return plan.status();
  auto face = read_face(*plan);
  if (!face.ok()) return face.status();
  auto model = server::to_face_model_spec(plan->plan.model());
  if (!model.ok()) return model.status();
  auto spec = server::to_simulation_spec(plan->plan.simulation());
  if (!spec.ok()) return spec.status();
  aim_at_settled_shape(*plan->plan.mutable_simulation()->mutable_time());
  auto settled_shape = server::to_simulation_spec(plan->plan.simulation());
  if (!settled_shape.ok()) return settled_shape.status();
  std::get<geometry::ScanRegionSpec>(model->region).scan = *std::move(face);
  if (const absl::Status status = refine(scale, *model, spec->films[0]); !status.ok()) return status;
  settled_shape->films = spec->films;
  return SampleFace{*std::move(model), *std::move(spec), *std::move(settled_shape)};
}

absl::StatusOr<JawAngle> make_jaw_angle(int scale) {
  auto face = load_sample_face(scale);
  if (!face.ok()) return face.status();
  return build(scale, *std::move(face));
}

absl::StatusOr<JawAngle> make_attached_jaw_angle(int scale) {
  auto face = load_sample_face(scale);
  if (!face.ok()) return face.status();
  for (model::TissueLayerSpec& layer : face->model.layers) layer.material.law = solid::TissueLaw::kNeoHookean;
  for (plan::SimulationSpec* spec : {&face->simulation, &face->settled_shape}) {
    for (plan::FilmSpec& film : spec->films) film.edge = {};
  }
  return build(scale, *std::move(face));
}

}  // namespace lipofill::bench
