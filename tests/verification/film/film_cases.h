#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/simulation/simulation.h"

namespace lipofill::verification {

/// A flat region without tissue, for films with walls of their own.
inline std::shared_ptr<const model::FaceModel> make_bare_square(double length_xi_m, double length_eta_m) {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{length_xi_m, length_eta_m};
  spec.n_xi = 2;
  spec.n_eta = 2;
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return model.ok() ? *model : nullptr;
}

/// A film over the whole square, in one zone.
inline plan::FilmSpec make_film(plan::FilmWallKind wall, int n_xi, int n_eta) {
  plan::FilmSpec film;
  film.name = "film";
  film.wall = wall;
  film.n_xi = n_xi;
  film.n_eta = n_eta;
  film.zones = {{"all", geometry::ChartBox{}}};
  return film;
}

inline std::unique_ptr<simulation::Simulation> make_simulation(std::shared_ptr<const model::FaceModel> model,
                                                               const plan::SimulationSpec& spec) {
  auto created = simulation::Simulation::create(std::move(model), spec);
  EXPECT_TRUE(created.ok()) << created.status();
  return created.ok() ? *std::move(created) : nullptr;
}

/// A strip of cells between rigid walls, 4 mm wide, with two cells probed.
struct Slot {
  double length = 0.05;  ///< [m]
  geometry::ScalarField thickness = geometry::ScalarField::constant(1e-3);
  int n = 20;
  int first = 4;  ///< probes 0 and 1
  int last = 14;
};

/// `spec` in a slot along which a steady flux [m2/s] runs from the first cell to the last for up to
/// 10 s.
inline std::unique_ptr<simulation::Simulation> make_slot(plan::SimulationSpec spec, const Slot& slot, double flux) {
  const double width = 4e-3;
  const auto centre = [&](int cell) { return geometry::ChartPoint{(cell + 0.5) / slot.n, 0.5}; };
  spec.films = {make_film(plan::FilmWallKind::kRigid, slot.n, 1)};
  spec.films[0].rest_thickness = slot.thickness;
  const double rate = flux * width;
  if (rate > 0.0) {
    spec.injections = {{"all", rate * 10.0, rate, 0.0, centre(0)},
                       {"all", -rate * 10.0, rate, 0.0, centre(slot.n - 1)}};
  }
  spec.probes = {{"first", "film", centre(slot.first)}, {"last", "film", centre(slot.last)}};
  spec.settle_skin_speed = 0.0;
  return make_simulation(make_bare_square(slot.length, width), spec);
}

/// Pressure at the first probe less that at the second [Pa].
inline double probed_drop(const simulation::Simulation& simulation) {
  return simulation.report().probe_pressure[0] - simulation.report().probe_pressure[1];
}

/// Runs until the simulation ends; it must not fail.
inline void run(simulation::Simulation& simulation) {
  while (simulation.phase() == simulation::Phase::kRunning) simulation.advance_step();
  EXPECT_NE(simulation.phase(), simulation::Phase::kFailed) << simulation.reason();
}

/// Order of convergence from errors at two resolutions a factor 2 apart.
inline double observed_order(double coarse, double fine) {
  return std::log2(std::abs(coarse) / std::abs(fine));
}

}  // namespace lipofill::verification
