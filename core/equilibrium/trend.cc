#include "core/equilibrium/trend.h"

#include <cmath>
#include <optional>

namespace lipofill::equilibrium {
namespace {

/// A move may leave a line by this share of its length.
constexpr double kStraightness = 1e-9;

/// t with b = t a; nothing where b is not along a.
std::optional<double> ratio(const Eigen::VectorXd& b, const Eigen::VectorXd& a) {
  if (a.size() == 0 || b.size() != a.size()) return {};
  const double t = a.dot(b) / a.squaredNorm();
  if (!((b - t * a).norm() <= kStraightness * b.norm())) return {};
  return t;
}

}  // namespace

void Trend::forget() {
  begin({});
}

void Trend::begin(Eigen::MatrixXd per_volume) {
  per_volume_ = std::move(per_volume);
  last_ = before_ = {};
}

Eigen::VectorXd Trend::predict(const Eigen::VectorXd& volume) const {
  const std::optional<double> ahead = ratio(volume, last_.volume);
  const std::optional<double> behind = ratio(before_.volume, last_.volume);
  if (!ahead || !behind || !(std::abs(1.0 + *behind) > kStraightness)) return per_volume_ * volume;
  // Newton's form over the shapes at 0, -1 and -1 - b of the last move.
  const Eigen::VectorXd bend = (last_.unknowns - before_.unknowns / *behind) / (1.0 + *behind);
  return *ahead * last_.unknowns + *ahead * (*ahead + 1.0) * bend;
}

void Trend::learn(const Eigen::VectorXd& volume, const Eigen::VectorXd& unknowns) {
  const double size = volume.squaredNorm();
  if (!(size > 0.0)) return;
  per_volume_.noalias() += (unknowns - per_volume_ * volume) * (volume.transpose() / size);
  before_ = std::exchange(last_, {volume, unknowns});
}

}  // namespace lipofill::equilibrium
