// A thick neo-Hookean sphere and cylinder (b/a = 2) inflated until the inner radius has grown by
// half, nu = 0.4999. Incompressible closed forms: with r the radius now, R that at rest and
// lambda = r/R
//
//     sphere    r^3 = R^3 + a^3 - A^3,   p = int_a^b 2 mu (lambda^2 - lambda^-4) dr/r
//     cylinder  r^2 = R^2 + a^2 - A^2,   p = int_a^b mu (lambda^2 - lambda^-2) dr/r       plane strain

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/record.h"
#include "tests/verification/solid/block_mesh.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Case;
using verification::with_number;

constexpr double kInner = 0.010;
constexpr double kOuter = 0.020;
constexpr double kStretch = 1.5;
constexpr double kPoissonRatio = 0.4999;
constexpr double kShear = 1e3;
constexpr double kTolerance = 1e-9;

struct Expected {
  double pressure;
  double outer;  ///< radius now [m]
};

/// `dimension` 2: cylinder, 3: sphere. Simpson's rule over the wall.
Expected integrate_wall(int dimension) {
  const double grown = std::pow(kStretch * kInner, dimension) - std::pow(kInner, dimension);
  const auto radius_now = [&](double R) { return std::pow(std::pow(R, dimension) + grown, 1.0 / dimension); };
  const double outer = radius_now(kOuter);
  constexpr int kPanels = 2000;
  const double h = (outer - kStretch * kInner) / kPanels;
  double sum = 0.0;
  for (int k = 0; k <= kPanels; ++k) {
    const double r = kStretch * kInner + k * h;
    const double R = std::pow(std::pow(r, dimension) - grown, 1.0 / dimension);
    const double stretch = r / R;
    const double difference = dimension == 3 ? 2.0 * (std::pow(stretch, 2) - std::pow(stretch, -4))
                                             : std::pow(stretch, 2) - std::pow(stretch, -2);
    sum += (k == 0 || k == kPanels ? 1.0 : (k % 2 == 1 ? 4.0 : 2.0)) * kShear * difference / r;
  }
  return {sum * h / 3.0, outer};
}

/// A quarter of a cylinder one element long along z; zeta through the wall.
HexMesh make_quarter(int n, bool stacked) {
  BlockMesh blocks(1e-6 * kInner);
  blocks.add_block({2 * n, 1, n}, stacked, [n](const Eigen::Vector3d& s) -> Eigen::Vector3d {
    const double angle = 0.5 * M_PI * (1.0 - s[0]);
    const double radius = kInner + (kOuter - kInner) * s[2];
    return {radius * std::cos(angle), radius * std::sin(angle), -0.005 * s[1] / n};
  });
  return blocks.finish();
}

/// Three blocks, one round each axis, each a third of an eighth of a sphere.
HexMesh make_eighth(int n, bool stacked) {
  BlockMesh blocks(1e-6 * kInner);
  for (int axis = 0; axis < 3; ++axis) {
    blocks.add_block({n, n, n}, stacked, [axis](const Eigen::Vector3d& s) -> Eigen::Vector3d {
      Eigen::Vector3d direction;
      direction[axis] = 1.0;
      direction[(axis + 1) % 3] = std::tan(0.25 * M_PI * s[0]);
      direction[(axis + 2) % 3] = std::tan(0.25 * M_PI * s[1]);
      return (kInner + (kOuter - kInner) * s[2]) * direction.normalized();
    });
  }
  return blocks.finish();
}

struct Measured {
  double pressure;  ///< work of the inner nodes' forces over the volume that they sweep
  double outer;
};

/// Inner nodes are moved outwards; dp V = sum f . dx with x = lambda X there.
Measured inflate(int dimension, int n, bool stacked) {
  const HexMesh mesh = dimension == 3 ? make_eighth(n, stacked) : make_quarter(n, stacked);
  const double youngs_modulus = 2.0 * (1.0 + kPoissonRatio) * kShear;
  Tissue tissue =
      Tissue::create(mesh, {{youngs_modulus, kPoissonRatio, 1000.0, 0.0, TissueLaw::kNeoHookean}}, {}, {}).value();
  const auto radius = [&](const Eigen::Vector3d& x) { return dimension == 3 ? x.norm() : x.head<2>().norm(); };
  LargeDeformation problem{{}, mesh.rest_positions, Eigen::Matrix3Xd::Zero(3, mesh.n_nodes())};
  std::vector<int> inner, outer;
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    const Eigen::Vector3d X = mesh.rest_positions.col(a);
    problem.held.push_back({X[0] < kTolerance, X[1] < kTolerance, dimension == 2 || X[2] < kTolerance});
    if (radius(X) > kOuter - kTolerance) outer.push_back(a);
    if (radius(X) > kInner + kTolerance) continue;
    inner.push_back(a);
    problem.held[a] = {true, true, true};
    problem.prescribed.col(a).head(dimension) *= kStretch;
  }
  const StaticState state = solve_large_deformation(tissue, problem, 3);
  EXPECT_TRUE(state.converged);
  double work = 0.0;
  for (const int a : inner) {
    const Eigen::Vector3d force = tissue.internal_force().segment<3>(3 * a);
    work += force.head(dimension).dot(mesh.rest_positions.col(a).head(dimension));
  }
  // The inner face is of flat quadrilaterals: its own volume counts, dV/dlambda = dimension
  // V/lambda.
  const auto is_inner = [&](int e) {
    return radius(mesh.rest_positions.col(mesh.hexahedra[e][0])) < kInner + kTolerance;
  };
  const double swept = compute_pressure_force(mesh, is_inner, true, 1.0)
                           .topRows(dimension)
                           .cwiseProduct(mesh.rest_positions.topRows(dimension))
                           .sum();
  double sum = 0.0;
  for (const int a : outer) sum += radius(state.x.col(a));
  return {work / (swept * std::pow(kStretch, dimension - 1)), sum / static_cast<double>(outer.size())};
}

void expect_inflation(const char* id, const char* title, int dimension, bool stacked) {
  Case inflation({id, title, "The incompressible closed form, integrated over the wall."});
  const Expected expected = integrate_wall(dimension);
  const std::string kind = stacked ? ", stacked" : ", solid-shell";
  const std::vector<double> sizes = dimension == 3 ? std::vector<double>{3, 6} : std::vector<double>{4, 8};
  std::vector<double> errors;
  Measured fine{};
  for (const double n : sizes) {
    fine = inflate(dimension, static_cast<int>(n), stacked);
    errors.push_back(fine.pressure / expected.pressure - 1.0);
  }
  inflation.record({with_number("pressure, %g elements through the wall", sizes.back()) + kind, "Pa", expected.pressure,
                    fine.pressure, 0.02});
  inflation.record({"outer radius" + kind, "mm", 1e3 * expected.outer, 1e3 * fine.outer, 2e-3});
  inflation.record_series({"pressure" + kind, "elements through the wall", sizes, errors, 2.0, 1.7});
}

TEST(NeoHookeanSphere, IsInflatedAsInTheClosedForm) {
  for (const bool stacked : {false, true}) {
    expect_inflation("solid/11b-neo-hookean-sphere", "Inflated thick neo-Hookean sphere", 3, stacked);
  }
}

TEST(NeoHookeanCylinder, IsInflatedAsInTheClosedForm) {
  for (const bool stacked : {false, true}) {
    expect_inflation("solid/11c-neo-hookean-cylinder", "Inflated thick neo-Hookean cylinder", 2, stacked);
  }
}

}  // namespace
}  // namespace lipofill::solid::testing
