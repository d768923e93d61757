// A face is the same face in another frame, with its vertices in another order, and in another
// size.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "tests/property/small_runs.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 0.1;
constexpr int kSteps = 12;

Vector3d on_sphere(double longitude, double latitude) {
  return kRadius * Vector3d(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                            std::sin(latitude));
}

/// A region of a piece of a sphere, its four corners all different.
geometry::ScanRegionSpec make_region() {
  geometry::ScanRegionSpec region;
  region.scan = geometry::make_sphere_cap(kRadius, 1.2, 30);
  region.corners = {on_sphere(-0.24, -0.25), on_sphere(0.26, -0.22), on_sphere(0.25, 0.27), on_sphere(-0.22, 0.24)};
  return region;
}

/// What a plan does to the skin of a scanned face [mm].
Eigen::Matrix3Xd run_on_scan(const geometry::ScanRegionSpec& region, const plan::SimulationSpec& spec) {
  model::FaceModelSpec face = make_small_model_spec();
  face.region = region;
  const auto model = model::build_face_model(face, nullptr);
  if (!model.ok()) RC_FAIL(model.status().ToString());
  const auto simulation = start(spec, *model);
  advance(*simulation, kSteps);
  return skin_displacement(*simulation);
}

RC_GTEST_PROP(Invariance, AFaceTurnedAndMovedIsTheSameFace, ()) {
  const plan::SimulationSpec spec = pick_plan();
  const Vector3d axis(pick("axis x", 0.1, 1.0), pick("axis y", -1.0, 1.0), pick("axis z", -1.0, 1.0));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(pick("angle", 0.0, 6.0), axis.normalized()).toRotationMatrix();
  const Vector3d shift(pick("shift x [m]", 0.0, 0.5), pick("shift y [m]", 0.0, 0.5), pick("shift z [m]", 0.0, 0.5));
  geometry::ScanRegionSpec moved = make_region();
  moved.scan.points = (turn * moved.scan.points).colwise() + shift;
  for (geometry::SkinPoint& corner : moved.corners) corner = Vector3d(turn * std::get<Vector3d>(corner) + shift);
  const Eigen::Matrix3Xd there = run_on_scan(moved, spec);
  RC_ASSERT(difference(turn.transpose() * there, run_on_scan(make_region(), spec)) <= 1e-5);
}

/// The same surface with its vertices and triangles in another order, each triangle begun at
/// another corner.
geometry::SurfaceMesh renumber(const geometry::SurfaceMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> place(static_cast<size_t>(mesh.n_vertices()));
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), random);
  geometry::SurfaceMesh other = mesh;
  for (int v = 0; v < mesh.n_vertices(); ++v) other.points.col(place[static_cast<size_t>(v)]) = mesh.points.col(v);
  for (std::array<int, 3>& triangle : other.triangles) {
    for (int& vertex : triangle) vertex = place[static_cast<size_t>(vertex)];
    std::rotate(triangle.begin(), triangle.begin() + static_cast<int>(random() % 3), triangle.end());
  }
  std::shuffle(other.triangles.begin(), other.triangles.end(), random);
  return other;
}

RC_GTEST_PROP(Invariance, TheOrderOfVerticesAndTrianglesDoesNotMatter, ()) {
  const plan::SimulationSpec spec = pick_plan();
  geometry::ScanRegionSpec renumbered = make_region();
  renumbered.scan = renumber(renumbered.scan, *rc::gen::inRange(0u, 1000u).as("order"));
  RC_ASSERT(difference(run_on_scan(renumbered, spec), run_on_scan(make_region(), spec)) <= 1e-5);
}

/// A field with its values multiplied; only constant ones are needed here.
geometry::ScalarField scaled(double value, double size) {
  return geometry::ScalarField::constant(value * size);
}

/// The small model `size` times as large. Inertia, rho L^2 / (E t^2), stays with the density
/// divided by size^2.
model::FaceModelSpec scale_model(double size) {
  model::FaceModelSpec face = make_small_model_spec();
  face.region = geometry::SquareSpec{0.048 * size, 0.048 * size};
  face.layers[0].geometry.thickness = scaled(2e-3, size);
  face.layers[1].geometry.thickness = scaled(8e-3, size);
  for (model::TissueLayerSpec& layer : face.layers) layer.material.density /= size * size;
  return face;
}

/// The plan for it: lengths times `size`, volumes and their rates times size^3; times, pressures
/// and viscosity stay.
plan::SimulationSpec scale_plan(plan::SimulationSpec spec, double size) {
  spec.films[0].rest_thickness = scaled(0.05e-3, size);
  for (plan::InjectionSpec& injection : spec.injections) {
    injection.volume *= size * size * size;
    injection.rate *= size * size * size;
  }
  spec.fat_density /= size * size;
  spec.error_tolerance *= size;
  return spec;
}

/// The flux of a film of fat, -h^3 / (12 mu) grad p, gives the same time to each size: Newtonian or
/// not.
RC_GTEST_PROP(Invariance, AFaceOfAnotherSizeIsSimilar, ()) {
  const plan::SimulationSpec spec = pick_plan();
  const double size = pick("size", 0.8, 1.25);
  const auto model = model::build_face_model(scale_model(size), nullptr);
  if (!model.ok()) RC_FAIL(model.status().ToString());
  const auto usual = start(spec), other = start(scale_plan(spec, size), *model);
  advance(*usual, kSteps);
  advance(*other, kSteps);
  RC_ASSERT(difference(skin_displacement(*other) / size, skin_displacement(*usual)) <= 1e-4);
  const double pressure = usual->report().max_pressure;
  RC_ASSERT(std::abs(other->report().max_pressure - pressure) <= 1e-4 * pressure);
}

}  // namespace
}  // namespace lipofill::simulation
