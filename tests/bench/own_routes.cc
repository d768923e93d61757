// The project's own factor (core/coupling/supernodal_factor.h), in single and in double precision.

#include <utility>

#include "core/coupling/coupled_factor.h"
#include "tests/bench/dense_cholesky.h"
#include "tests/bench/phase_clock.h"
#include "tests/bench/route.h"

namespace lipofill::bench {
namespace {

using coupling::CoupledFactor;
using coupling::FactorAnalysis;
using coupling::Precision;
using Eigen::VectorXd;

/// Factor of [S B^T; B 0] up to the pressures, which leaves C; dense J + C; and the same again on
/// what is left of both equations until that is small. A step of a simulation does not correct: its
/// next iteration does.
class OwnFactor : public Route {
 public:
  OwnFactor(std::shared_ptr<const FactorAnalysis> analysis, Precision precision)
      : factor_(std::move(analysis)), precision_(precision) {}

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    if (!factor_.factorise(step.s, step.b, precision_)) return absl::InternalError("not positive definite");
    clock.done("factor");
    const DenseCholesky films(factor_.compliance() + Eigen::MatrixXd(step.j));
    if (!films.is_definite()) return absl::InternalError("J + C is not positive definite");
    clock.done("pressure");
    LinearAnswer& x = result.answer;
    x = solve(films, step.f, step.d);
    clock.done("solve");
    for (double change = 1.0; change > kTolerance && result.iterations < kMaxCorrections; ++result.iterations) {
      const LinearAnswer more = solve(
          films, step.f - step.s.selfadjointView<Eigen::Lower>() * x.displacement + step.b.transpose() * x.pressure,
          step.d - step.b * x.displacement - step.j * x.pressure);
      x.displacement += more.displacement;
      x.pressure += more.pressure;
      change = std::max(more.displacement.norm() / x.displacement.norm(), more.pressure.norm() / x.pressure.norm());
    }
    clock.done("corrections");
    result.phases = clock.take();
    return result;
  }

 private:
  static constexpr double kTolerance = 1e-10;
  static constexpr int kMaxCorrections = 30;

  LinearAnswer solve(const DenseCholesky& films, const VectorXd& f, const VectorXd& d) {
    VectorXd response, dx;
    factor_.solve_gap_response(f, response);
    const VectorXd pressure = films.solve(d - response);
    factor_.solve_displacement(pressure, dx);
    return {dx, pressure};
  }

  CoupledFactor factor_;
  Precision precision_;
};

RouteKind own(const char* name, const char* what, Precision precision) {
  return {name, what, [precision](const LinearStep& step) -> absl::StatusOr<std::unique_ptr<Route>> {
            auto analysis = FactorAnalysis::create(step.s, step.b);
            if (!analysis.ok()) return analysis.status();
            return std::make_unique<OwnFactor>(*std::move(analysis), precision);
          }};
}

}  // namespace

std::vector<RouteKind> own_routes() {
  return {own("own_single", "the project's own factor in single precision, corrected in double precision to 1e-10",
              Precision::kSingle),
          own("own_double", "the same in double precision", Precision::kDouble)};
}

}  // namespace lipofill::bench
