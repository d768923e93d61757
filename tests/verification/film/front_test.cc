// Peeling fronts under a plate, and the whole range of viscosity, thickness and step.

#include <algorithm>
#include <string>
#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using simulation::Phase;

model::TissueLayerSpec make_layer(const std::string& name, double thickness, double youngs_modulus) {
  model::TissueLayerSpec layer;
  layer.name = name;
  layer.geometry = {ScalarField::constant(thickness), 1};
  layer.material = {youngs_modulus, 0.45, 1100.0};
  return layer;
}

struct Front {
  double place = 0.0;            ///< where the film is 0.5 mm thick [m]
  double thickness = 0.0;        ///< the film has it at the source [m]
  double lowest_pressure = 0.0;  ///< ever [Pa]
  double void_volume = 0.0;      ///< largest [m3]
};

/// A strip of a 2 mm plate over a pre-wetted film that 5 mm2/s of fat of 15 Pa s peels from one end
/// for 4 s.
Front peel(int n, double rest_thickness, double suction_limit) {
  const double length = 0.06;
  const double width = 1.5e-3;
  model::FaceModelSpec model_spec;
  model_spec.region = geometry::SquareSpec{length, width};
  model_spec.n_xi = 2 * n;
  model_spec.n_eta = 2;
  model_spec.layers = {make_layer("plate", 2e-3, 1e5)};
  model_spec.rim.kind = model::SupportKind::kRollers;
  auto model = model::build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  plan::SimulationSpec spec;
  spec.films = {make_film(plan::FilmWallKind::kTissue, n, 1)};
  spec.films[0].below_layer = "plate";
  spec.films[0].rest_thickness = ScalarField::constant(rest_thickness);
  const double rate = 5e-6 * width;
  spec.injections = {{"all", rate * 4.0, rate, 0.0, ChartPoint{0.5 / n, 0.5}}};
  if (suction_limit > 0.0) spec.suction_limit = suction_limit;
  spec.step = 0.02;
  spec.end = 4.0;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(*model, spec);
  Front front;
  while (simulation->phase() == Phase::kRunning) {
    simulation->advance_step();
    front.lowest_pressure = std::min(front.lowest_pressure, simulation->report().min_pressure);
    front.void_volume = std::max(front.void_volume, simulation->report().void_volume);
  }
  EXPECT_EQ(simulation->phase(), Phase::kFinished) << simulation->reason();
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
  EXPECT_LT(simulation->report().gap_volume_relative_error, 1e-4);
  front.thickness = simulation->report().max_thickness;
  for (const auto& field : simulation->frame({"film/film"})) {
    if (field.name != "thickness") continue;
    for (int i = 0; i + 1 < n; ++i) {
      const double here = field.values[i] - 0.5;
      const double next = field.values[i + 1] - 0.5;
      if (here > 0.0 && next <= 0.0) front.place = length * (i + 0.5 + here / (here - next)) / n;
    }
  }
  return front;
}

void record_convergence(const std::string& cut_off, double rest_thickness, double suction_limit) {
  Case record({"fat/5-peeling-front", "A peeling front at a fixed cut-off",
               "refinement against itself: cells of 2, 1 and 0.5 mm; the cut-off, not the cell, limits the suction"});
  const Front coarse = peel(30, rest_thickness, suction_limit);
  const Front middle = peel(60, rest_thickness, suction_limit);
  const Front fine = peel(120, rest_thickness, suction_limit);
  const auto change = [&](double Front::*figure, const Front& a) {
    return std::abs(a.*figure - fine.*figure) / std::abs(fine.*figure);
  };
  record.record(
      {cut_off + ": front, change from 1 to 0.5 mm", "1", 0.015, change(&Front::place, middle), 0.0, Bound::kAtMost});
  record.record({cut_off + ": thickness at the source, change from 1 to 0.5 mm", "1", 0.01,
                 change(&Front::thickness, middle), 0.0, Bound::kAtMost});
  record.record({cut_off + ": lowest pressure, change from 1 to 0.5 mm", "1", 0.05,
                 change(&Front::lowest_pressure, middle), 0.0, Bound::kAtMost});
  record.record({cut_off + ": lowest pressure", "Pa", 0.0, fine.lowest_pressure, 0.0, Bound::kReported});
  EXPECT_LT(change(&Front::thickness, middle), change(&Front::thickness, coarse));
  EXPECT_LT(change(&Front::lowest_pressure, middle), change(&Front::lowest_pressure, coarse) + 1e-12);
  if (suction_limit > 0.0) {
    EXPECT_GT(fine.void_volume, 0.0);
    record.record({cut_off + ": largest void, change from 1 to 0.5 mm", "1", 0.1, change(&Front::void_volume, middle),
                   0.0, Bound::kAtMost});
  } else {
    EXPECT_EQ(fine.void_volume, 0.0);
  }
}

TEST(PeelingFront, ConvergesAtAFixedPreWettedThickness) {
  record_convergence("pre-wetted 0.2 mm", 0.2e-3, 0.0);
}

TEST(PeelingFront, ConvergesAtAFixedSuctionLimit) {
  record_convergence("suction limit 500 Pa", 0.2e-3, 500.0);
}

// Fat of any viscosity in a film of any thickness at any step: accepted steps are stable, hold
// their volume and stay positive.
TEST(AnyFat, AnyThicknessAndAnyStepAreStable) {
  Case record({"fat/6-any-fat", "Viscosity 0.01 to 1000 Pa s, films of 0.02 to 10 mm, steps of 1 ms to 10 s",
               "volume to round-off, gap equal to film, positive thickness, no failure"});
  model::FaceModelSpec model_spec;
  model_spec.region = geometry::SquareSpec{0.048, 0.048};
  model_spec.n_xi = model_spec.n_eta = 12;
  model_spec.layers = {make_layer("skin", 2e-3, 1e5), make_layer("muscle", 8e-3, 2e5)};
  auto model = model::build_face_model(model_spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  double volume_error = 0.0, gap_error = 0.0;
  int runs = 0;
  for (const double thickness : {0.02e-3, 0.5e-3, 10e-3}) {
    for (const double viscosity : {0.01, 3.0, 1000.0}) {
      for (const double step : {1e-3, 0.1, 10.0}) {
        plan::SimulationSpec spec;
        spec.films = {make_film(plan::FilmWallKind::kTissue, 6, 6)};
        spec.films[0].below_layer = "skin";
        spec.films[0].rest_thickness = ScalarField::constant(thickness);
        spec.injections = {{"all", 0.3e-6, 1e-6, std::nullopt, ChartPoint{0.55, 0.45}}};
        spec.fat_viscosity = viscosity;
        spec.step = step;
        spec.end = 40.0 * step;
        spec.settle_skin_speed = 0.0;
        auto simulation = make_simulation(*model, spec);
        ASSERT_TRUE(simulation);
        while (simulation->phase() == Phase::kRunning) {
          simulation->advance_step();
          volume_error = std::max(volume_error, simulation->report().film_volume_relative_error);
          gap_error = std::max(gap_error, simulation->report().gap_volume_relative_error);
        }
        EXPECT_EQ(simulation->phase(), Phase::kFinished)
            << thickness << " m " << viscosity << " Pa s " << step << " s: " << simulation->reason();
        for (const auto& field : simulation->frame({"film/film"})) {
          if (field.name != "thickness") continue;
          EXPECT_GT(*std::min_element(field.values.begin(), field.values.end()), 0.0f);
        }
        ++runs;
      }
    }
  }
  record.record({"combinations run to their end", "1", 27.0, static_cast<double>(runs), 0.0, Bound::kAbsolute});
  record.record({"largest relative error of the film's volume", "1", 1e-12, volume_error, 0.0, Bound::kAtMost});
  record.record({"largest relative difference of gap and film", "1", 1e-4, gap_error, 0.0, Bound::kAtMost});
}

}  // namespace
}  // namespace lipofill::verification
