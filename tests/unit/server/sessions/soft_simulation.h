#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "core/simulation/simulation.h"

namespace lipofill::server {

/// Skin over a film, injected for a tenth of a second and at rest some seconds later.
inline std::unique_ptr<simulation::Simulation> make_soft_simulation() {
  model::FaceModelSpec face;
  face.region = geometry::SquareSpec{0.04, 0.04};
  face.n_xi = face.n_eta = 16;
  face.layers = {{"skin", {geometry::ScalarField::constant(3e-3), 1}, {6e4, 0.45, 1100.0}}};
  const auto model = model::build_face_model(face, [](double, const char*) { return true; });
  EXPECT_TRUE(model.ok()) << model.status();
  plan::SimulationSpec spec;
  plan::FilmSpec film;
  film.name = "plane";
  film.below_layer = "skin";
  film.n_xi = film.n_eta = 8;
  film.rest_thickness = geometry::ScalarField::constant(0.5e-3);
  film.zones = {{"all", geometry::ChartBox{0.2, 0.8, 0.2, 0.8}}};
  spec.films = {film};
  spec.injections = {{"all", 1e-7, 1e-6, 0.0, std::nullopt}};
  spec.settle_skin_speed = 0.05e-3;
  spec.max_step = 0.5;
  auto made = simulation::Simulation::create(*model, spec);
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

}  // namespace lipofill::server
