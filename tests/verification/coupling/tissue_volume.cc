#include "tests/verification/coupling/tissue_volume.h"

#include <cstdio>
#include <string>

#include "absl/strings/str_cat.h"
#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using simulation::Phase;
using solid::TissueLaw;

constexpr double kInjected = 1e-6;
constexpr double kRadius = 12e-3;
constexpr double kTissueKept = 0.005;

plan::SimulationSpec make_plan(const model::FaceModel& model, const std::string& below) {
  plan::SimulationSpec spec;
  spec.films = {make_film(plan::FilmWallKind::kTissue, model.geometry.grid.n_xi / 2, model.geometry.grid.n_eta / 2)};
  spec.films[0].below_layer = below;
  spec.films[0].zones = {{"pocket", plan::Disc{ChartPoint{0.5, 0.5}, kRadius}}};
  spec.films[0].rest_thickness = ScalarField::constant(0.05e-3);
  spec.injections = {{"pocket", kInjected, 1e-6, 0.0, std::nullopt}};
  spec.fat_viscosity = 15.0;
  spec.step = 0.01;
  spec.max_step = 2.0;
  spec.end = 300.0;
  spec.settle_skin_speed = 2e-6;
  return spec;
}

}  // namespace

std::shared_ptr<const model::FaceModel> build_with_law(model::FaceModelSpec spec, TissueLaw law) {
  for (model::TissueLayerSpec& layer : spec.layers) layer.material.law = law;
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return model.ok() ? *std::move(model) : nullptr;
}

KeptVolume fill_disc(const std::shared_ptr<const model::FaceModel>& model, const std::string& below) {
  auto simulation = make_simulation(model, make_plan(*model, below));
  if (!simulation) return {};
  while (simulation->phase() == Phase::kRunning) simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kSettled) << below << ": " << simulation->reason();
  double rest = 0.0, now = 0.0;
  for (const simulation::LayerReport& layer : simulation->layer_reports()) {
    std::printf("  %s %.4f -> %.4f mL\n", layer.name.c_str(), 1e6 * layer.rest_volume, 1e6 * layer.volume);
    rest += layer.rest_volume;
    now += layer.volume;
  }
  const simulation::StepReport& report = simulation->report();
  std::printf("%s: %lu steps, %lu taken back, pressure %.0f Pa, lift %.3f mm, J %.3f\n", below.c_str(), report.step,
              report.rejected_steps, report.mean_pressure, 1e3 * report.skin_max_displacement,
              report.min_scaled_jacobian);
  return {now / rest - 1.0, report.skin_volume_change / kInjected};
}

void expect_volume_kept(const model::FaceModelSpec& spec, const std::string& where) {
  Case record(
      {"coupled/11-tissue-volume", "Neo-Hookean tissue keeps its volume",
       "1 mL in a disc 24 mm wide: the layers keep their volume within 0.5 %, and the skin rises by the fat's"});
  const auto model = build_with_law(spec, TissueLaw::kNeoHookean);
  ASSERT_TRUE(model);
  for (const model::TissueLayerSpec& layer : spec.layers) {
    const KeptVolume kept = fill_disc(model, layer.name);
    const std::string name = absl::StrCat(where, ", below ", layer.name);
    record.record({name + ": change of the tissue's volume", "1", kTissueKept, kept.tissue, 0.0, Bound::kAtMost});
    record.record({name + ": volume under the skin over the fat's", "1", 1.0, kept.skin, 0.05});
  }
}

}  // namespace lipofill::verification
