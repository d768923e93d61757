#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>

#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"
#include "core/planning/proposal_fit.h"
#include "core/simulation/trial_shape.h"
#include "tests/unit/anatomy/faces.h"
#include "tests/unit/geometry/jaw_angle_region.h"

namespace lipofill::planning {

constexpr double kMillilitre = 1e-6;
constexpr double kMillimetre = 1e-3;

/// The model of the sample plan jaw_angle on its face, at the paper's size or coarser.
inline std::shared_ptr<const model::FaceModel> make_jaw_model(int n_xi, int n_eta) {
  geometry::ScanRegionSpec region = anatomy::read_face(LIPOFILL_SAMPLE_FACES, "half_face");
  region.corners = geometry::make_jaw_angle_corners();
  model::FaceModelSpec spec;
  spec.region = std::move(region);
  spec.n_xi = n_xi;
  spec.n_eta = n_eta;
  spec.layers = {{"skin", {geometry::ScalarField::constant(4.25e-3), 1}, {90e3, 0.45, 1100.0}},
                 {"muscle", {geometry::ScalarField::constant(8e-3), 1}, {500e3, 0.45, 1050.0}}};
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

/// Its two zones, with volumes.
inline plan::SimulationSpec make_jaw_plan(double masseter, double angle) {
  plan::SimulationSpec spec;
  plan::FilmSpec film;
  film.name = "deep";
  film.below_layer = "skin";
  film.zones = {{"masseter", plan::NamedRegion{"masseter_left"}},
                {"mandibular_angle", plan::NamedRegion{"mandibular_angle_left"}}};
  spec.films = {film};
  spec.injections = {{"masseter", masseter, 1e-6, std::nullopt, std::nullopt},
                     {"mandibular_angle", angle, 1e-6, std::nullopt, std::nullopt}};
  spec.goal = plan::TimeGoal::kSettledShape;
  return spec;
}

/// The face that a plan makes of a model's scan (a square's skin), each vertex off by `noise` rms
/// along its normal, as scanners have it.
inline geometry::SurfaceMesh make_target(const std::shared_ptr<const model::FaceModel>& model,
                                         const plan::SimulationSpec& plan, double noise, unsigned seed) {
  auto trial = simulation::TrialShape::create(model, plan);
  EXPECT_TRUE(trial.ok()) << trial.status();
  EXPECT_TRUE((*trial)->find({}, false).ok());
  const SkinPoints points = make_skin_points(*model);
  const Eigen::Matrix3Xd moved = points.gather((*trial)->skin_displacement());
  geometry::SurfaceMesh target = model->is_square ? points.rest : model->geometry.scan;
  for (Eigen::Index k = 0; k < points.n(); ++k) {
    const Eigen::Index vertex = model->is_square ? k : model->geometry.riders[static_cast<size_t>(k)].vertex;
    target.points.col(vertex) += moved.col(k);
  }
  std::mt19937 random(seed);
  // Sums of twelve, which are the same with every library.
  const auto gaussian = [&] {
    double sum = -6.0;
    for (int k = 0; k < 12; ++k) sum += static_cast<double>(random()) / 4294967296.0;
    return sum;
  };
  const Eigen::Matrix3Xd normals = geometry::compute_vertex_normals(target);
  for (Eigen::Index v = 0; v < target.points.cols(); ++v) target.points.col(v) += noise * gaussian() * normals.col(v);
  return target;
}

}  // namespace lipofill::planning
