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
  next = y + f;
  if (n_ == 0) {
    moved_.resize(y.size(), kDepth);
    changed_.resize(y.size(), kDepth);
  } else {
    const int column = (n_ - 1) % kDepth;
    moved_.col(column) = y - last_y_;
    changed_.col(column) = f - last_f_;
    const int n = std::min(n_, kDepth);
    const auto measured = changed_.topLeftCorner(n_measured, n);
    // The normal equations of columns scaled to one: nine digits are enough for shares.
    const Eigen::VectorXd scale = measured.colwise().norm().cwiseMax(1e-300).cwiseInverse().transpose();
    const Eigen::MatrixXd gram = scale.asDiagonal() * (measured.transpose() * measured) * scale.asDiagonal();
    const Eigen::VectorXd right = scale.asDiagonal() * (measured.transpose() * f.head(n_measured));
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver;
    solver.setThreshold(kLeastIndependence);
    solver.compute(gram);
    const Eigen::VectorXd shares = scale.asDiagonal() * solver.solve(right);
    next.noalias() -= moved_.leftCols(n) * shares;
    next.noalias() -= changed_.leftCols(n) * shares;
  }
  last_y_ = y;
  last_f_ = f;
  ++n_;
}

}  // namespace lipofill::equilibrium
