// A constant flux from a point into a film on a Winkler wall, p = k h. Similarity: with R the
// front, s = r/R and h = (R R'/beta)^(1/3) f(s),
//
//     (s f^3 f')' = -s^2 f',   f(1) = 0,     Q = 2 pi beta (R R'/beta)^(4/3) m,   m = lim s -> 0 of -s f^3 f'
//
// so that R = sqrt(2) (2 pi m)^(-3/8) (beta Q^3)^(1/8) t^(1/2).

#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using plan::FilmWallKind;

constexpr double kPi = 3.14159265358979323846;

/// g = f^3 and m = -s f^3 f' = -s f g'/3 at places s, from the front inwards: g' = -3 m/(s f),
/// m' = s^2 f' = -s m/g.
struct SimilarityProfile {
  std::vector<double> s, g, m;

  SimilarityProfile() {
    const double near = 1e-6;  // near the front g = 3 (1 - s), m = f s
    double at = 1.0 - near;
    Eigen::Vector2d y(3.0 * near, std::cbrt(3.0 * near));
    const auto slope = [](double x, const Eigen::Vector2d& v) {
      return Eigen::Vector2d(-3.0 * v[1] / (x * std::cbrt(v[0])), -x * v[1] / v[0]);
    };
    while (at > 1e-4) {
      s.push_back(at);
      g.push_back(y[0]);
      m.push_back(y[1]);
      const double d = -std::min({0.05 * (1.0 - at), 0.05 * at, 1e-3});
      const Eigen::Vector2d k1 = slope(at, y);
      const Eigen::Vector2d k2 = slope(at + 0.5 * d, y + 0.5 * d * k1);
      const Eigen::Vector2d k3 = slope(at + 0.5 * d, y + 0.5 * d * k2);
      const Eigen::Vector2d k4 = slope(at + d, y + d * k3);
      y += d / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      at += d;
    }
  }
  double prefactor() const { return std::sqrt(2.0) * std::pow(2.0 * kPi * m.back(), -0.375); }
  double cubed(double at) const {
    if (at >= s.front()) return 0.0;
    size_t k = 1;
    while (k + 1 < s.size() && s[k] > at) ++k;
    return g[k] + (at - s[k]) / (s[k - 1] - s[k]) * (g[k - 1] - g[k]);
  }
};

/// Where h^3 reaches zero, by a parabola through its values at three places a, b, c < front.
double extrapolate_front(const std::array<double, 3>& r, const std::array<double, 3>& cubed) {
  const double first = (cubed[1] - cubed[0]) / (r[1] - r[0]);
  const double second = ((cubed[2] - cubed[1]) / (r[2] - r[1]) - first) / (r[2] - r[0]);
  // Newton from beyond the last place on N(r) = cubed[0] + first (r - r0) + second (r - r0)(r - r1)
  double at = r[2];
  for (int k = 0; k < 50; ++k) {
    const double value = cubed[0] + first * (at - r[0]) + second * (at - r[0]) * (at - r[1]);
    at -= value / (first + second * (2.0 * at - r[0] - r[1]));
  }
  return at;
}

double front_of(const SimilarityProfile& profile) {
  const std::array<double, 3> r = {0.7, 0.8, 0.9};
  return extrapolate_front(r, {profile.cubed(r[0]), profile.cubed(r[1]), profile.cubed(r[2])});
}

TEST(PointSource, FrontGrowsWithTheSquareRootOfTime) {
  Case source({"film/3b-point-source", "Constant flux from a point on a Winkler wall",
               "Similarity solution by quadrature in the test: R = 0.71502 (beta Q^3)^(1/8) t^(1/2)."});
  const SimilarityProfile exact;
  EXPECT_NEAR(exact.prefactor(), 0.71502, 1e-5);
  EXPECT_NEAR(front_of(exact), 1.0, 2e-3);

  const double stiffness = 1e6;
  const double viscosity = 10.0;
  const double rate = 1e-7;
  const double scale = std::pow(stiffness / (12.0 * viscosity) * rate * rate * rate, 0.125);
  const double end = 16.0;
  const double side = 1.15 * exact.prefactor() * scale * std::sqrt(end);
  const int n = 48;
  plan::SimulationSpec spec;
  spec.fat_viscosity = viscosity;
  spec.films = {make_film(FilmWallKind::kWinkler, n, n)};
  spec.films[0].wall_stiffness = stiffness;
  spec.films[0].rest_thickness = ScalarField::constant(0.0);
  spec.injections = {{"all", rate * end, 0.25 * rate, 0.0, ChartPoint{0.5 / n, 0.5 / n}}};
  for (int i = 0; i < n; ++i)
    spec.probes.push_back({"p" + std::to_string(i), "film", ChartPoint{(i + 0.5) / n, 0.5 / n}});
  spec.step = 0.4;
  spec.end = end;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_bare_square(side, side), spec);
  ASSERT_TRUE(simulation);

  Curve curve{"front", "t [s]", "R [mm]", {}, {}, {}, true};
  while (simulation->phase() == simulation::Phase::kRunning) {
    simulation->advance_step();
    const double t = simulation->report().time;
    if (t < 0.999) continue;
    const double expected = exact.prefactor() * scale * std::sqrt(t);
    std::array<double, 3> r{}, cubed{};
    for (int k = 0; k < 3; ++k) {
      const int i = static_cast<int>((0.7 + 0.1 * k) * expected / side * n);
      r[k] = side / n * std::hypot(i + 0.5, 0.5);
      cubed[k] = std::pow(simulation->report().probe_thickness[i], 3);
    }
    curve.x.push_back(t);
    curve.measured.push_back(1e3 * extrapolate_front(r, cubed));
    curve.expected.push_back(1e3 * expected);
  }
  ASSERT_EQ(simulation->phase(), simulation::Phase::kFinished) << simulation->reason();
  size_t quarter = 0;
  while (curve.x[quarter] < 0.25 * end) ++quarter;
  const double exponent =
      std::log(curve.measured.back() / curve.measured[quarter]) / std::log(curve.x.back() / curve.x[quarter]);
  source.record({"prefactor at 16 s", "1", 0.71502, curve.measured.back() / (1e3 * scale * std::sqrt(end)), 0.01});
  source.record({"exponent between 4 and 16 s", "1", 0.5, exponent, 0.02});
  source.record_curve(curve);
}

}  // namespace
}  // namespace lipofill::verification
