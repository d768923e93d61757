// Every named region, on both sides of every face at hand: the model is built around the region,
// fat is injected, and the tissue comes to rest; or the region is refused with what is to blame. At
// least 98 of 100 come to rest. Results that are not to be relied upon say so: a scaled Jacobian
// below 0.2, a pressure above 10 kPa, tissue that loses or gains more than 2 % of its volume.
//
// It takes long and runs only with LIPOFILL_EVERY_FACE=1 (deploy/faces).
// LIPOFILL_FACE and LIPOFILL_REGION, regular expressions, choose some.

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numbers>
#include <regex>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/anatomy/regions.h"
#include "core/anatomy/tissue_presets.h"
#include "core/model/face_model.h"
#include "core/plan/step_rules.h"
#include "core/simulation/simulation.h"
#include "tests/integration/faces/face_files.h"

namespace lipofill::testing {
namespace {

constexpr double kLeastShare = 0.98;
constexpr double kMeanThickness = 1.5e-3;  // [m] of the fat that is injected
constexpr int kHexahedra = 24;             // along each direction of the chart
std::string setting(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool is_chosen(const std::string& name, const char* variable) {
  const std::string pattern = setting(variable);
  return pattern.empty() || std::regex_search(name, std::regex(pattern));
}

/// What came of a region on a face.
struct Outcome {
  std::string state;   ///< SETTLED, FINISHED, FAILED, or REFUSED
  std::string reason;  ///< of a refusal or a failure, else the figures
  std::vector<std::string> remarks;
  std::vector<std::string> owed = {};  ///< parts of the remarks that its figures ask for
  bool has_come_to_rest() const { return state == "SETTLED"; }
};

/// What the remarks on a shape have to hold.
std::vector<std::string> find_owed_remarks(const simulation::Simulation& simulation) {
  std::vector<std::string> owed;
  if (simulation.report().min_scaled_jacobian < 0.2) owed.emplace_back("The tissue is distorted");
  if (simulation.report().max_pressure > 10e3) owed.emplace_back("The fat presses with");
  double before = 0.0, after = 0.0;
  for (const simulation::LayerReport& layer : simulation.layer_reports()) {
    before += layer.rest_volume;
    after += layer.volume;
  }
  if (std::abs(after / before - 1.0) > 0.02) owed.emplace_back("of its volume");
  return owed;
}

model::TissueLayerSpec make_layer(const std::string& name, anatomy::TissueKind kind, double thickness) {
  const anatomy::TissueFigures figures = anatomy::figures_of(anatomy::TissuePreset::kPaper, kind);
  model::TissueLayerSpec layer;
  layer.name = name;
  layer.geometry = {geometry::ScalarField::constant(thickness), 1};
  layer.material.youngs_modulus = figures.youngs_modulus;
  layer.material.poisson_ratio = figures.poisson_ratio;
  layer.material.density = figures.density;
  return layer;
}

/// The planner's own layers.
model::FaceModelSpec make_model_spec(const geometry::ScanRegionSpec& face, const std::string& region) {
  model::FaceModelSpec spec;
  spec.region = face;
  spec.n_xi = spec.n_eta = kHexahedra;
  spec.layers = {make_layer("skin", anatomy::TissueKind::kSkin, 1.8e-3),
                 make_layer("subcutaneous", anatomy::TissueKind::kSubcutaneous, 3e-3),
                 make_layer("muscle", anatomy::TissueKind::kMuscle, 8e-3)};
  spec.around = model::AroundSpec{{region}, {}, 12e-3};
  return spec;
}

plan::SimulationSpec make_plan(const geometry::ScanRegionSpec& face, const std::string& region) {
  plan::SimulationSpec spec;
  plan::FilmSpec film;
  film.name = "deep";
  film.below_layer = "subcutaneous";
  film.n_xi = film.n_eta = kHexahedra / 2;
  film.zones = {{"zone", plan::NamedRegion{region}}};
  spec.films = {film};
  const auto placed = anatomy::place_region_by_landmarks(face.landmarks, {}, region);
  EXPECT_TRUE(placed.ok()) << placed.status();
  plan::InjectionSpec injection;
  injection.zone = "zone";
  injection.volume = kMeanThickness * std::numbers::pi * placed->half_length * placed->half_width;
  injection.rate = 1e-6;
  spec.injections = {injection};
  spec.goal = plan::TimeGoal::kSettledShape;
  const plan::TimeFigures figures = plan::figures_of(spec.goal);
  spec.max_step = figures.max_step;
  spec.max_injection_step = figures.max_injection_step;
  spec.error_tolerance = figures.error_tolerance;
  spec.end = 300.0;
  spec.settle_skin_speed = 0.01e-3;
  return spec;
}

Outcome carry_out(const geometry::ScanRegionSpec& face, const std::string& region) {
  const auto model = model::build_face_model(make_model_spec(face, region), nullptr);
  if (!model.ok()) return {"REFUSED", std::string(model.status().message()), {}};
  auto simulation = simulation::Simulation::create(*model, make_plan(face, region));
  if (!simulation.ok()) {
    return {"REFUSED", std::string(simulation.status().message()), (*model)->geometry.cautions};
  }
  while ((*simulation)->phase() == simulation::Phase::kRunning) (*simulation)->advance_step();
  const simulation::StepReport& report = (*simulation)->report();
  const auto state = (*simulation)->phase() == simulation::Phase::kSettled    ? "SETTLED"
                     : (*simulation)->phase() == simulation::Phase::kFinished ? "FINISHED"
                                                                              : "FAILED";
  Outcome outcome{state, (*simulation)->reason(), (*simulation)->remarks()};
  if (outcome.has_come_to_rest()) {
    outcome.owed = find_owed_remarks(**simulation);
    outcome.reason = absl::StrFormat("%.2f mL, %.2f mm, %.2f kPa, scaled Jacobian %.2f of %.2f at rest, %.1f cm2",
                                     report.injected * 1e6, report.skin_max_displacement * 1e3,
                                     report.max_pressure * 1e-3, report.min_scaled_jacobian,
                                     (*model)->geometry.grid.min_scaled_jacobian, (*model)->geometry.skin_area * 1e4);
  }
  return outcome;
}

std::vector<FaceFile> find_faces() {
  std::vector<FaceFile> chosen;
  for (const FaceFile& face : find_face_files(std::filesystem::path(LIPOFILL_SHARED_DATA) / "faces")) {
    if (is_chosen(face.stem, "LIPOFILL_FACE")) chosen.push_back(face);
  }
  return chosen;
}

std::vector<std::string> find_regions() {
  std::vector<std::string> chosen;
  for (const std::string& stem : anatomy::region_names()) {
    for (const char* side : {"_left", "_right"}) {
      if (is_chosen(stem + side, "LIPOFILL_REGION")) chosen.push_back(stem + side);
    }
  }
  return chosen;
}

TEST(EveryRegion, ComesToRestOrIsRefusedWithItsCause) {
  if (setting("LIPOFILL_EVERY_FACE").empty()) GTEST_SKIP() << "it takes long: deploy/faces runs it";
  const std::vector<FaceFile> faces = find_faces();
  if (faces.empty()) GTEST_SKIP() << "no faces in " << LIPOFILL_SHARED_DATA << "/faces";
  int all = 0;
  int at_rest = 0;
  std::map<std::string, int> remarked;
  for (const FaceFile& file : faces) {
    const geometry::ScanRegionSpec face = read_face_file(file);
    for (const std::string& region : find_regions()) {
      const Outcome outcome = carry_out(face, region);
      ++all;
      at_rest += outcome.has_come_to_rest();
      std::printf("%-8s %-22s %-8s %s\n", file.stem.c_str(), region.c_str(), outcome.state.c_str(),
                  outcome.reason.c_str());
      for (const std::string& remark : outcome.remarks) std::printf("%-32s %s\n", "", remark.c_str());
      std::fflush(stdout);
      for (const std::string& owed : outcome.owed) {
        ++remarked[owed];
        EXPECT_THAT(outcome.remarks, ::testing::Contains(::testing::HasSubstr(owed))) << file.stem << " " << region;
      }
      if (outcome.has_come_to_rest()) continue;
      EXPECT_EQ(outcome.state, "REFUSED") << file.stem << " " << region << ": " << outcome.reason;
      EXPECT_THAT(outcome.reason, ::testing::ContainsRegex("border|fold|landmark")) << file.stem << " " << region;
    }
  }
  std::printf("%d of %d came to rest (%.1f %%)\n", at_rest, all, 100.0 * at_rest / all);
  for (const auto& [remark, count] : remarked) std::printf("%d with the remark: %s\n", count, remark.c_str());
  EXPECT_GE(at_rest, kLeastShare * all);
}

}  // namespace
}  // namespace lipofill::testing
