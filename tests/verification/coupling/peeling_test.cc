// A thin plate on a pre-wetted film, fat injected at a constant rate: the blister peels the plate
// off by bending (Lister, Peng & Neufeld 2013). Inside, the pressure is even and the plate a
// clamped one; its rim is a travelling wave of film and bending that takes the pre-wetted thickness
// h0 to the blister's curvature kappa, at the speed
//
//     R' = D h0^(1/2) kappa^(5/2) / (12 mu c^(5/2));    H^3 H^(5) = -(H - 1), H -> 1 ahead, H'' -> c behind
//
//     round:   kappa = 24 Q t/(pi R^4)     R = [22/7  (24/pi)^(5/2)/(12 c^(5/2))  D h0^(1/2) Q^(5/2)/mu]^(1/11)
//     t^(7/22) plane:   kappa = 15 q t/R^3          R = [17/7  15^(5/2)/(12 c^(5/2))  D h0^(1/2) q^(5/2)/mu]^(2/17)
//     t^(7/17)
//
// with q the flux to one side.

#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;

/// The wave at the blister's rim, from x = -kBehind to kAhead, by the box scheme for (H, H', ...,
/// H'''') and Newton.
class RimWave {
 public:
  RimWave() {
    for (int k = 0; k <= kIntervals; ++k) {
      const double behind = std::max(0.0, -at(k));
      y_.segment<5>(5 * k) << 1.0 + 0.675 * behind * behind, -1.35 * behind, behind > 0.0 ? 1.35 : 0.0, 0.0, 0.0;
    }
    for (int k = 0; k < 30; ++k) {
      const Eigen::VectorXd change = solve_newton();
      y_ += change;
      if (change.cwiseAbs().maxCoeff() < 1e-9) return;
    }
    ADD_FAILURE() << "the wave at the rim is not found";
  }
  /// H'' far behind: H'' = c - 2/(3 c^2 |x|) as H -> c x^2/2.
  double curvature() const {
    double c = y_[2];
    for (int k = 0; k < 50; ++k) c = y_[2] + 2.0 / (3.0 * c * c * kBehind);
    return c;
  }

 private:
  static constexpr int kIntervals = 800;
  static constexpr double kBehind = 40.0;
  static constexpr double kAhead = 16.0;
  static double at(int k) { return -kBehind + (kBehind + kAhead) * k / kIntervals; }

  void add(int row, int column, double value) { entries_.emplace_back(row, column, value); }

  Eigen::VectorXd solve_newton() {
    constexpr int kUnknowns = 5 * (kIntervals + 1);
    entries_.clear();
    Eigen::VectorXd residual = Eigen::VectorXd::Zero(kUnknowns);
    const double dx = at(1) - at(0);
    for (int k = 0; k < kIntervals; ++k) {
      const Eigen::Matrix<double, 5, 1> middle = 0.5 * (y_.segment<5>(5 * k) + y_.segment<5>(5 * k + 5));
      const double H = middle[0];
      for (int c = 0; c < 5; ++c) {
        const int row = 5 * k + c;
        const double slope = c < 4 ? middle[c + 1] : -(H - 1.0) / (H * H * H);
        residual[row] = y_[row + 5] - y_[row] - dx * slope;
        const int column = 5 * k + (c < 4 ? c + 1 : 0);
        const double derivative = c < 4 ? 1.0 : (2.0 * H - 3.0) / (H * H * H * H);
        add(row, row, -1.0);
        add(row, row + 5, 1.0);
        add(row, column, -0.5 * dx * derivative);
        add(row, column + 5, -0.5 * dx * derivative);
      }
    }
    add_ends(5 * kIntervals, residual);
    Eigen::SparseMatrix<double> jacobian(kUnknowns, kUnknowns);
    jacobian.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(jacobian);
    return factor.solve(-residual);
  }

  /// Behind: H''' and H'''' as they follow from H^(5) = -1/H^2. Ahead: at rest. And where the wave
  /// is: H(0) = 2.
  void add_ends(int row, Eigen::VectorXd& residual) {
    const double H = y_[0];
    residual[row] = y_[4] + kBehind / (3.0 * H * H);
    add(row, 4, 1.0);
    add(row, 0, -2.0 * kBehind / (3.0 * H * H * H));
    residual[row + 1] = y_[3] - 0.5 * kBehind * y_[4];
    add(row + 1, 3, 1.0);
    add(row + 1, 4, -0.5 * kBehind);
    residual[row + 2] = y_[5 * kIntervals] - 1.0;
    add(row + 2, 5 * kIntervals, 1.0);
    residual[row + 3] = y_[5 * kIntervals + 1];
    add(row + 3, 5 * kIntervals + 1, 1.0);
    const int origin = 5 * static_cast<int>(std::lround(kBehind / (kBehind + kAhead) * kIntervals));
    residual[row + 4] = y_[origin] - 2.0;
    add(row + 4, origin, 1.0);
  }

  Eigen::VectorXd y_ = Eigen::VectorXd::Zero(5 * (kIntervals + 1));
  std::vector<Eigen::Triplet<double>> entries_;
};

constexpr double kPi = 3.14159265358979323846;
constexpr double kThickness = 1e-3;
constexpr double kYoungsModulus = 1e9;
constexpr double kNu = 0.45;
constexpr double kViscosity = 1e-3;
constexpr double kPrewetted = 0.0033e-3;
/// Height of the blister at the end over the pre-wetted thickness: far above 1 for the similarity
/// to hold, and a tenth of the plate's thickness, for bending alone.
constexpr double kHeight = 30.0;
constexpr double kRadius = 0.06;  ///< the front is there at the end [m]
const double kBending = kYoungsModulus * std::pow(kThickness, 3) / (12.0 * (1.0 - kNu * kNu));

/// R = (prefactor . D h0^(1/2) rate^(5/2)/mu)^power t^(7/2 power)
struct FrontLaw {
  double constant = 0.0;  ///< the bracket of the law has it
  double power = 0.0;
  double rate = 0.0;  ///< [m3/s], or [m2/s] to one side
  double radius(double t) const {
    const double bracket = kBending * std::sqrt(kPrewetted) * std::pow(rate, 2.5) / kViscosity;
    return std::pow(constant * bracket * std::pow(t, 3.5), power);
  }
  /// The time at which the front is at kRadius with `volume` injected; sets the rate.
  double choose_rate(double volume) {
    const double bracket = constant * kBending * std::sqrt(kPrewetted) / kViscosity;
    const double t = std::pow(kRadius, 1.0 / power) / (bracket * std::pow(volume, 2.5));
    rate = volume / t;
    return t;
  }
};

/// A part of the plate between planes of symmetry on all sides, with a film of n_x x n_y cells fed
/// at the origin.
struct Blister {
  double length_x, length_y;
  int n_x, n_y;
  double rate;  ///< into this part [m3/s]
};

/// Radius over time, from where the square root of the lift, linear in r^2, reaches zero.
Curve peel(const Blister& blister, const FrontLaw& law, double end, int steps) {
  model::FaceModelSpec model_spec;
  model_spec.region = geometry::SquareSpec{blister.length_x, blister.length_y};
  model_spec.n_xi = 2 * blister.n_x;
  model_spec.n_eta = 2 * blister.n_y;
  model_spec.layers = {{"plate", {ScalarField::constant(kThickness), 1}, {kYoungsModulus, kNu, 1000.0}}};
  model_spec.rim.kind = model::SupportKind::kRollers;
  const auto model = model::build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  plan::SimulationSpec spec;
  spec.fat_viscosity = kViscosity;
  spec.films = {make_film(plan::FilmWallKind::kTissue, blister.n_x, blister.n_y)};
  spec.films[0].below_layer = "plate";
  spec.films[0].rest_thickness = ScalarField::constant(kPrewetted);
  const ChartPoint origin{0.5 / blister.n_x, 0.5 / blister.n_y};
  spec.injections = {{"all", 2.0 * blister.rate * end, blister.rate, 0.0, origin}};
  const int last = static_cast<int>(0.65 * kRadius / blister.length_x * blister.n_x) + 1;
  for (int i = 0; i < last; ++i) {
    spec.probes.push_back({"p" + std::to_string(i), "film", ChartPoint{(i + 0.5) / blister.n_x, origin.eta}});
  }
  spec.step = end / steps;
  spec.end = end;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(*model, spec);
  Curve curve{"radius", "t [s]", "R [mm]", {}, {}, {}, true};
  const double width = blister.length_x / blister.n_x;
  const double off_axis = blister.n_y > 1 ? 0.5 * width : 0.0;
  while (simulation->phase() == simulation::Phase::kRunning) {
    simulation->advance_step();
    const double t = simulation->report().time;
    const auto& h = simulation->report().probe_thickness;
    const int a = static_cast<int>(0.15 * law.radius(t) / width);
    const int b = static_cast<int>(0.6 * law.radius(t) / width);
    if (t < 0.2 * end || a == b) continue;
    const auto square = [&](int i) { return std::pow(width * (i + 0.5), 2) + off_axis * off_axis; };
    const auto root = [&](int i) { return std::sqrt(std::max(0.0, h[i] - kPrewetted)); };
    curve.x.push_back(t);
    curve.expected.push_back(1e3 * law.radius(t));
    curve.measured.push_back(1e3 * std::sqrt(square(a) + root(a) / (root(a) - root(b)) * (square(b) - square(a))));
  }
  EXPECT_EQ(simulation->phase(), simulation::Phase::kFinished) << simulation->reason();
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
  return curve;
}

void record_front(Case& peeling, const FrontLaw& law, const Curve& curve, double exponent_tolerance,
                  double prefactor_tolerance) {
  const double exponent =
      std::log(curve.measured.back() / curve.measured.front()) / std::log(curve.x.back() / curve.x.front());
  peeling.record({"exponent over a factor 5 in time", "1", 3.5 * law.power, exponent, exponent_tolerance});
  peeling.record({"prefactor at the end", "1", std::pow(law.constant, law.power),
                  std::pow(law.constant, law.power) * curve.measured.back() / curve.expected.back(),
                  prefactor_tolerance});
  peeling.record_curve(curve);
}

TEST(PeelingByBending, RoundBlister) {
  Case peeling({"coupled/7a-round-blister", "Peeling by bending at constant flux",
                "R = 1.31263 (D h0^(1/2) Q^(5/2)/mu)^(1/11) t^(7/22); the wave at the rim is solved in the test."});
  const double c = RimWave().curvature();
  FrontLaw law{22.0 / 7.0 * std::pow(24.0 / kPi, 2.5) / (12.0 * std::pow(c, 2.5)), 1.0 / 11.0};
  peeling.record(
      {"prefactor by quadrature of the wave at the rim", "1", 1.31263, std::pow(law.constant, law.power), 1e-3});
  const double end = law.choose_rate(kPi * kRadius * kRadius * kHeight * kPrewetted / 3.0);
  const double length = 1.4 * kRadius;
  const int n = 20;
  record_front(peeling, law, peel({length, length, n, n, 0.25 * law.rate}, law, end, 40), 0.05, 0.1);
}

TEST(PeelingByBending, PlaneBlister) {
  Case peeling({"coupled/7b-plane-blister", "Peeling by bending at constant flux, a plane blister",
                "R = [17/7 15^(5/2)/(12 c^(5/2)) D h0^(1/2) q^(5/2)/mu]^(2/17) t^(7/17)."});
  FrontLaw law{17.0 / 7.0 * std::pow(15.0, 2.5) / (12.0 * std::pow(RimWave().curvature(), 2.5)), 2.0 / 17.0};
  const double end = law.choose_rate(8.0 / 15.0 * kRadius * kHeight * kPrewetted);
  const double length = 1.45 * kRadius;
  const int n = 80;
  const double width = length / n;
  record_front(peeling, law, peel({length, width, n, 1, law.rate * width}, law, end, 200), 0.05, 0.1);
}

}  // namespace
}  // namespace lipofill::verification
