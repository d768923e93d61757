#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "core/simulation/simulation.h"

namespace lipofill::simulation {

/// Two layers of 12 x 12 hexahedra over 48 x 48 mm.
inline model::FaceModelSpec make_small_model_spec() {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{0.048, 0.048};
  spec.n_xi = spec.n_eta = 12;
  spec.layers = {{"skin", {geometry::ScalarField::constant(2e-3), 1}, {1e5, 0.45, 1100.0}},
                 {"muscle", {geometry::ScalarField::constant(8e-3), 1}, {2e5, 0.45, 1050.0}}};
  return spec;
}

inline std::shared_ptr<const model::FaceModel> make_small_model() {
  auto model = model::build_face_model(make_small_model_spec(), nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return model.ok() ? *model : nullptr;
}

/// One film of 6 x 6 cells between the layers; 0.3 mL at its middle in 0.3 s.
inline plan::SimulationSpec make_small_plan() {
  plan::SimulationSpec spec;
  plan::FilmSpec film;
  film.name = "film";
  film.below_layer = "skin";
  film.n_xi = film.n_eta = 6;
  film.zones = {{"all", plan::ChartBox{}}};
  spec.films = {film};
  spec.injections = {{"all", 0.3e-6, 1e-6, std::nullopt, geometry::ChartPoint{0.55, 0.45}}};
  spec.probes = {{"centre", "", geometry::ChartPoint{0.55, 0.45}}};
  spec.end = 10.0;
  return spec;
}

inline std::unique_ptr<Simulation> make_small_simulation(const plan::SimulationSpec& spec = make_small_plan()) {
  auto created = Simulation::create(make_small_model(), spec);
  EXPECT_TRUE(created.ok()) << created.status();
  return created.ok() ? *std::move(created) : nullptr;
}

}  // namespace lipofill::simulation
