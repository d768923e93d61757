#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/simulation/simulation.h"

namespace lipofill::verification {

/// A flat region without tissue, for films with walls of their own.
inline std::shared_ptr<const simulation::FaceModel> make_bare_square(double length_xi_m, double length_eta_m) {
  simulation::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{length_xi_m, length_eta_m};
  spec.n_xi = 2;
  spec.n_eta = 2;
  auto model = simulation::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return model.ok() ? *model : nullptr;
}

/// A film over the whole square, in one zone.
inline simulation::FilmSpec make_film(simulation::FilmWallKind wall, int n_xi, int n_eta) {
  simulation::FilmSpec film;
  film.name = "film";
  film.wall = wall;
  film.n_xi = n_xi;
  film.n_eta = n_eta;
  film.zones = {{"all", simulation::ChartBox{}}};
  return film;
}

inline std::unique_ptr<simulation::Simulation> make_simulation(std::shared_ptr<const simulation::FaceModel> model,
                                                               const simulation::SimulationSpec& spec) {
  auto created = simulation::Simulation::create(std::move(model), spec);
  EXPECT_TRUE(created.ok()) << created.status();
  return created.ok() ? *std::move(created) : nullptr;
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
