// Viscosity of the film with inertia: a decaying vortex, a shear layer, and flows that start from
// rest.

#include <vector>

#include "core/film/viscosity.h"
#include "tests/verification/film/film_cases.h"
#include "tests/verification/film/flat_box.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNu = 0.01;
constexpr auto kDrag = film::WallFriction::kNoSlip;
constexpr auto kNoDrag = film::WallFriction::kNone;

/// Implicit steps of viscosity alone on a film of thickness 1, with a body force [m/s2] a unit of
/// velocity.
Eigen::VectorXd diffuse(const FlatBox& box, film::WallFriction wall_friction, Eigen::VectorXd u, double time, int steps,
                        const Eigen::VectorXd& force) {
  film::ImplicitViscosity viscosity(box.grid);
  film::Fat fat;
  fat.viscosity = kNu;
  fat.density = 1.0;
  fat.wall_friction = wall_friction;
  const Eigen::VectorXd cells = Eigen::VectorXd::Ones(box.grid.n_cells());
  const Eigen::VectorXd edges = Eigen::VectorXd::Ones(box.grid.n_edges());
  const double dt = time / steps;
  for (int k = 0; k < steps; ++k) u = viscosity.advance(box.grid, box.metric, fat, cells, edges, u + dt * force, dt);
  return u;
}

/// What is left of the vortex after time 1: a quarter of the 2 pi box, which free-slip walls cut
/// out.
double vortex_decay(int n, int steps, film::WallFriction wall_friction) {
  const FlatBox box(n, n, kPi, kPi);
  const Eigen::VectorXd start = box.flow_of([](double x, double y) { return std::sin(x) * std::sin(y); });
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(start.size());
  return diffuse(box, wall_friction, start, 1.0, steps, none).norm() / start.norm();
}

TEST(TaylorGreen, DecaysWithAndWithoutWallDrag) {
  Case vortex({"film/4a-taylor-green", "Taylor-Green vortex, nu = 0.01, after t = 1",
               "exp(-2 nu t), times exp(-12 nu t/h^2) with wall drag, h = 1."});
  vortex.record({"velocity left, no drag", "1", 0.980199, vortex_decay(32, 40, kNoDrag), 5e-5, Bound::kAbsolute});
  vortex.record({"velocity left, wall drag", "1", 0.869358, vortex_decay(16, 400, kDrag), 3e-4, Bound::kAbsolute});
  std::vector<double> in_time, in_space;
  const double euler = std::pow(1.0 + 0.02 / 100.0, -100.0);  // what implicit Euler makes of the rate itself
  for (const int steps : {5, 10, 20}) in_time.push_back(vortex_decay(16, steps, kDrag) / std::exp(-0.14) - 1.0);
  for (const int n : {8, 16, 32}) in_space.push_back(vortex_decay(n, 100, kNoDrag) / euler - 1.0);
  vortex.record_series({"velocity left, wall drag", "steps", {5, 10, 20}, in_time, 1.0, 0.9});
  vortex.record_series({"velocity left, no drag", "cells a side", {8, 16, 32}, in_space, 2.0, 1.8});
}

/// Speeds along x across the middle of a long box, where its ends are not felt.
std::vector<double> speeds_across(const FlatBox& box, const Eigen::VectorXd& flow, double width) {
  std::vector<double> speeds;
  for (int j = 0; j < box.grid.n_eta; ++j) speeds.push_back(flow[box.x_edge(box.grid.n_xi / 2, j)] / width);
  return speeds;
}

struct Across {
  std::vector<double> y, measured, expected;
  /// Root mean square of the difference over that of the expected.
  double error() const {
    double difference = 0.0;
    double size = 0.0;
    for (size_t j = 0; j < y.size(); ++j) {
      difference += std::pow(measured[j] - expected[j], 2);
      size += std::pow(expected[j], 2);
    }
    return std::sqrt(difference / size);
  }
};

/// Runs a flow along x from u0(y), under the force a(y), over a width of 2 with y = 0 in the
/// middle.
template <typename Start, typename Force, typename Exact>
Across run_across(int n, double time, int steps, Start start, Force force, Exact exact) {
  const double length = 40.0 * std::sqrt(kNu * time);
  const FlatBox box(20, n, length, 2.0);
  const double width = 2.0 / n;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(box.grid.n_edges());
  Eigen::VectorXd a = u;
  Across across;
  for (int j = 0; j < n; ++j) {
    across.y.push_back(-1.0 + width * (j + 0.5));
    across.expected.push_back(exact(across.y.back()));
    for (int i = 1; i < box.grid.n_xi; ++i) {
      u[box.x_edge(i, j)] = width * start(across.y.back());
      a[box.x_edge(i, j)] = width * force(across.y.back());
    }
  }
  across.measured = speeds_across(box, diffuse(box, kNoDrag, u, time, steps, a), width);
  return across;
}

double side_of(double y) {
  return y < 0.0 ? -1.0 : 1.0;
}

/// Stokes' first problem. The film's side walls slip, so the wall is a plane of antisymmetry: a
/// jump of velocity that spreads.
TEST(StokesFirstProblem, SpreadsAsTheErrorFunction) {
  Case stokes({"film/4b-stokes", "Stokes' first problem: a layer of shear spreads in the plane of the film",
               "u = U erf(y/(2 sqrt(nu t))); the wall is a plane of antisymmetry."});
  const auto none = [](double) { return 0.0; };
  const double time = 1.0;
  const auto exact = [time](double y) { return std::erf(y / (2.0 * std::sqrt(kNu * time))); };
  const std::vector<double> cells = {16, 32, 64};
  std::vector<double> errors;
  Across across;
  for (const double n : cells) {
    across = run_across(static_cast<int>(n), time, static_cast<int>(n * n / 16.0), side_of, none, exact);
    errors.push_back(across.error());
  }
  stokes.record({"error of the profile, 64 cells across", "1", 5e-3, errors.back(), 0.0, Bound::kAtMost});
  stokes.record_series({"profile", "cells across", cells, errors, 2.0, 1.8});
  stokes.record_curve({"t = 1", "y", "u/U", across.y, across.measured, across.expected});
}

/// a b^2/(2 nu) [1 - s^2 - sum 4 (-1)^n/l^3 cos(l s) exp(-l^2 nu t/b^2)], l = (n + 1/2) pi, s the
/// distance from the middle over b.
double poiseuille(double s, double b, double t) {
  double sum = 1.0 - s * s;
  for (int n = 0; n < 60; ++n) {
    const double l = (n + 0.5) * kPi;
    sum -= (n % 2 == 0 ? 4.0 : -4.0) / (l * l * l) * std::cos(l * s) * std::exp(-l * l * kNu * t / (b * b));
  }
  return b * b / (2.0 * kNu) * sum;
}

/// Between planes where the velocity is zero, again by antisymmetry: the force changes sign at
/// y = 0, the middle of each channel lies on a slipping wall.
TEST(PoiseuilleStartUp, InThePlaneOfTheFilm) {
  Case channel({"film/4c-poiseuille", "Poiseuille flow starts from rest",
                "In the plane of the film: the Fourier series of plane Poiseuille flow."});
  const auto rest = [](double) { return 0.0; };
  const double time = 20.0;
  const auto exact = [time](double y) { return side_of(y) * poiseuille(1.0 - std::abs(y), 1.0, time); };
  const std::vector<double> cells = {8, 16, 32};
  std::vector<double> errors;
  Across across;
  for (const double n : cells) {
    across = run_across(static_cast<int>(n), time, static_cast<int>(n * n / 4.0), rest, side_of, exact);
    errors.push_back(across.error());
  }
  channel.record({"error of the profile, 32 cells across", "1", 5e-3, errors.back(), 0.0, Bound::kAtMost});
  channel.record_series({"profile", "cells across", cells, errors, 2.0, 1.8});
  channel.record_curve({"in the plane, t = 20", "y", "u nu/a", across.y, across.measured, across.expected});
}

/// Under gravity along a long strip with so soft a wall that nothing holds the flow back but drag:
/// the mean over the gap in the film's model, u' = g - 12 nu/h^2 u. (The exact mean of plane
/// Poiseuille flow starts at the rate pi^2 nu/h^2 in its slowest mode; its end state is the same.)
TEST(PoiseuilleStartUp, AcrossTheGap) {
  Case gap({"film/4c-poiseuille", "Poiseuille flow starts from rest",
            "Across the gap: u = g h^2/(12 nu) (1 - exp(-12 nu t/h^2)), the film's mean over the gap."});
  const double h = 2e-3;
  const double nu = 1e-5;
  const double rate = 12.0 * nu / (h * h);
  const double gravity = 0.01;
  const auto start_up = [&](double step, Curve& curve) {
    const int n = 51;
    plan::SimulationSpec spec;
    spec.fat_density = 1000.0;
    spec.fat_viscosity = nu * spec.fat_density;
    spec.gravity = {gravity, 0.0, 0.0};
    spec.films = {make_film(plan::FilmWallKind::kWinkler, n, 1)};
    spec.films[0].wall_stiffness = 1.0;
    spec.films[0].rest_thickness = geometry::ScalarField::constant(h);
    spec.step = step;
    spec.end = 0.1;
    spec.settle_skin_speed = 0.0;
    auto simulation = make_simulation(make_bare_square(0.2, 4e-3), spec);
    curve = {"across the gap", "t [s]", "u [mm/s]", {}, {}, {}};
    while (simulation->phase() == simulation::Phase::kRunning) {
      simulation->advance_step();
      const double t = simulation->report().time;
      curve.x.push_back(t);
      curve.expected.push_back(1e3 * gravity / rate * (1.0 - std::exp(-rate * t)));
      for (const simulation::FrameField& field : simulation->frame({"film/film"})) {
        if (field.name == "velocity") curve.measured.push_back(field.values[3 * (n / 2)]);
      }
    }
    EXPECT_EQ(simulation->phase(), simulation::Phase::kFinished) << simulation->reason();
    double worst = 0.0;
    for (size_t k = 0; k < curve.x.size(); ++k) {
      worst = std::max(worst, std::abs(curve.measured[k] - curve.expected[k]) / (1e3 * gravity / rate));
    }
    return worst;
  };
  Curve curve;
  const std::vector<double> steps = {4e-3, 2e-3, 1e-3};
  std::vector<double> errors;
  for (const double step : steps) errors.push_back(start_up(step, curve));
  gap.record({"velocity after 0.1 s, steps of 1 ms", "mm/s", curve.expected.back(), curve.measured.back(), 5e-3});
  gap.record_series({"velocity in time", "step [s]", steps, errors, 1.0, 0.9});
  gap.record_curve(curve);
}

}  // namespace
}  // namespace lipofill::verification
