#include "core/equilibrium/anderson.h"

#include <Eigen/QR>
#include <algorithm>

namespace lipofill::equilibrium {
namespace {

/// Differences that point the same way to within this share count as one.
constexpr double kLeastIndependence = 1e-10;

}  // namespace

void AndersonMixing::mix(const Eigen::VectorXd& y, const Eigen::VectorXd& f, Eigen::Index n_measured,
                         Eigen::VectorXd& next) {
  if (has_last_ && last_y_.size() == y.size()) learn(y - last_y_, f - last_f_, n_measured);
  apply(y, f, n_measured, next);
  last_y_ = y;
  last_f_ = f;
  has_last_ = true;
}

void AndersonMixing::learn(const Eigen::VectorXd& dy, const Eigen::VectorXd& df, Eigen::Index n_measured) {
  if (moved_.rows() != dy.size()) {
    n_ = 0;
    moved_.resize(dy.size(), kDepth);
    changed_.resize(dy.size(), kDepth);
    gram_.resize(kDepth, kDepth);
  }
  const int column = n_ % kDepth;
  moved_.col(column) = dy;
  changed_.col(column) = df;
  const int n = std::min(++n_, kDepth);
  const Eigen::VectorXd products = changed_.topLeftCorner(n_measured, n).transpose() * df.head(n_measured);
  gram_.col(column).head(n) = products;
  gram_.row(column).head(n) = products.transpose();
}

void AndersonMixing::apply(const Eigen::VectorXd& y, const Eigen::VectorXd& f, Eigen::Index n_measured,
                           Eigen::VectorXd& next) const {
  next = y + f;
  if (n_ == 0 || moved_.rows() != y.size()) return;
  const int n = std::min(n_, kDepth);
  // The normal equations of columns scaled to one: nine digits are enough for shares.
  const Eigen::VectorXd scale = gram_.diagonal().head(n).cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd gram = scale.asDiagonal() * gram_.topLeftCorner(n, n) * scale.asDiagonal();
  const Eigen::VectorXd right =
      scale.asDiagonal() * (changed_.topLeftCorner(n_measured, n).transpose() * f.head(n_measured));
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver;
  solver.setThreshold(kLeastIndependence);
  solver.compute(gram);
  const Eigen::VectorXd shares = scale.asDiagonal() * solver.solve(right);
  next.noalias() -= moved_.leftCols(n) * shares;
  next.noalias() -= changed_.leftCols(n) * shares;
}

}  // namespace lipofill::equilibrium
