#include "core/equilibrium/tangent.h"

#include "core/equilibrium/anderson.h"

namespace lipofill::equilibrium {
namespace {

constexpr int kMaxCorrections = 20;
/// A correction smaller than this share of the answer is the last one.
constexpr double kLeastCorrection = 2e-3;
/// Differences are taken over so much of the largest displacement [m].
constexpr double kDifference = 1e-7;

}  // namespace

std::optional<Tangent> find_tangent(StaticBalance& balance, HeldResponse& response, const Pools& pools,
                                    const Shape& shape, const Eigen::VectorXd& springs, const LoadChange& change) {
  const Eigen::VectorXd force = balance.force();
  const Eigen::VectorXd gap = shape.reduce(pools, balance.gap());
  const Eigen::Index n = shape.displacement.size();
  AndersonMixing mixing;
  Eigen::VectorXd answer = Eigen::VectorXd::Zero(n + shape.n_rows());
  Eigen::VectorXd correction(answer.size()), next, dx, dp;
  LoadChange left = change;
  std::optional<Tangent> found;
  for (int k = 0; k < kMaxCorrections && !found; ++k) {
    for (int pool = 0; pool < pools.n(); ++pool) {
      if (shape.is_at_limit[static_cast<size_t>(pool)] != 0) left.volume[pool] = 0.0;
    }
    if (!response.answer(balance, shape, left.force, left.volume, dx, dp)) break;
    correction << dx, dp;
    mixing.mix(answer, correction, n, next);
    answer = next;
    const double size = answer.head(n).norm();
    if (dx.norm() <= kLeastCorrection * size) found = Tangent{answer.head(n), answer.tail(shape.n_rows())};
    if (found || !(size > 0.0) || !answer.allFinite()) break;
    const double h = kDifference / answer.head(n).cwiseAbs().maxCoeff();
    Shape beside = shape;
    beside.displacement += h * answer.head(n);
    beside.pressure += h * answer.tail(shape.n_rows());
    balance.bring_to(beside, springs);
    left.force = change.force + (balance.force() - force) / h;
    left.volume = change.volume - (shape.reduce(pools, balance.gap()) - gap) / h;
    balance.bring_to(shape, springs);
  }
  return found;
}

}  // namespace lipofill::equilibrium
