#include "core/solid/wall_springs.h"

#include <algorithm>
#include <map>

namespace lipofill::solid {
namespace {

/// Rest lengths below this share of the tissue's extent are round-off of walls that touch.
constexpr double kTouchingShare = 1e-9;
/// A spring this near to its length counts as taut in the tangent, so that round-off at rest
/// decides nothing.
constexpr double kTautShare = 1.0 - 1e-9;

/// Coefficients of the nodes in d = x_outer - x_inner, nodes ascending, those of weight zero left
/// out.
std::map<int, double> collect_coefficients(const WallSpring& spring) {
  std::map<int, double> coefficients;
  for (int k = 0; k < 4; ++k) {
    if (spring.weight[k] == 0.0) continue;
    coefficients[spring.outer[k]] += spring.weight[k];
    coefficients[spring.inner[k]] -= spring.weight[k];
  }
  return coefficients;
}

double compute_extent(const Eigen::Matrix3Xd& x) {
  return x.cols() == 0 ? 0.0 : (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

}  // namespace

std::vector<std::vector<int>> collect_coupled_nodes(const std::vector<WallSpring>& springs) {
  std::vector<std::vector<int>> groups;
  for (const WallSpring& spring : springs) {
    groups.emplace_back();
    for (const auto& [node, coefficient] : collect_coefficients(spring)) groups.back().push_back(node);
  }
  return groups;
}

WallSprings::WallSprings(const std::vector<WallSpring>& springs, const Eigen::Matrix3Xd& rest,
                         const SystemPattern& pattern) {
  const double touching = kTouchingShare * compute_extent(rest);
  for (const WallSpring& spring : springs) {
    add_terms(spring, pattern);
    Spring& added = springs_.back();
    added.stiffness = spring.stiffness;
    const double rest_length = separation(added, rest).norm();
    added.taut_length = (rest_length < touching ? 0.0 : rest_length) + spring.slack;
  }
}

void WallSprings::add_terms(const WallSpring& spring, const SystemPattern& pattern) {
  Spring added{};
  added.first_term = static_cast<int>(terms_.size());
  added.first_block = static_cast<int>(blocks_.size());
  for (const auto& [node, coefficient] : collect_coefficients(spring)) {
    terms_.push_back({node, coefficient});
    for (size_t b = added.first_term; b < terms_.size(); ++b) add_block(terms_.back(), terms_[b], pattern);
  }
  added.n_terms = static_cast<int>(terms_.size()) - added.first_term;
  springs_.push_back(added);
}

void WallSprings::add_block(const Term& a, const Term& b, const SystemPattern& pattern) {
  const std::vector<int>& dofs = pattern.dof_of_component();
  Block block;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int row = dofs[3 * a.node + i];
      const int column = dofs[3 * b.node + j];
      const bool kept = row >= 0 && column >= 0 && (a.node != b.node || i >= j);
      block[3 * i + j] = kept ? pattern.find(row, column) : -1;
    }
  }
  blocks_.push_back(block);
}

template <typename Positions>
Eigen::Vector3d WallSprings::separation(const Spring& spring, const Positions& x) const {
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
  for (int a = spring.first_term; a < spring.first_term + spring.n_terms; ++a) {
    d += terms_[a].coefficient * x.col(terms_[a].node).template head<3>();
  }
  return d;
}

double WallSprings::add_force(const Eigen::Matrix4Xd& x, std::vector<WallSpringState>& states,
                              Eigen::Matrix4Xd& force) const {
  double energy = 0.0;
  for (size_t s = 0; s < springs_.size(); ++s) {
    const Spring& spring = springs_[s];
    WallSpringState& state = states[s];
    const Eigen::Vector3d d = separation(spring, x);
    state.length = d.norm();
    const double stretch = state.intact ? std::max(0.0, state.length - spring.taut_length) : 0.0;
    state.tension = spring.stiffness * stretch;
    energy += 0.5 * state.tension * stretch;
    if (state.tension == 0.0) continue;
    const Eigen::Vector3d pull = state.tension / state.length * d;
    for (int a = spring.first_term; a < spring.first_term + spring.n_terms; ++a) {
      force.col(terms_[a].node).head<3>() += terms_[a].coefficient * pull;
    }
  }
  return energy;
}

void WallSprings::add_tangent(const Eigen::Matrix4Xd& x, const std::vector<WallSpringState>& states,
                              TangentValues& values) const {
  const auto add_stiffness = [&values](int place, double value) { values.add_stiffness(place, value); };
  const auto add_geometric = [&values](int place, double value) { values.add_geometric(place, value); };
  for (size_t s = 0; s < springs_.size(); ++s) {
    const Spring& spring = springs_[s];
    const WallSpringState& state = states[s];
    if (!state.intact || state.length < kTautShare * spring.taut_length) continue;
    if (spring.taut_length == 0.0) {
      scatter(spring, spring.stiffness * Eigen::Matrix3d::Identity(), add_stiffness);
      continue;
    }
    const Eigen::Vector3d n = separation(spring, x) / state.length;
    const Eigen::Matrix3d along = n * n.transpose();
    scatter(spring, spring.stiffness * along, add_stiffness);
    scatter(spring, state.tension / state.length * (Eigen::Matrix3d::Identity() - along), add_geometric);
  }
}

template <typename Add>
void WallSprings::scatter(const Spring& spring, const Eigen::Matrix3d& tangent, Add add) const {
  int block = spring.first_block;
  for (int a = spring.first_term; a < spring.first_term + spring.n_terms; ++a) {
    for (int b = spring.first_term; b <= a; ++b, ++block) {
      const double factor = terms_[a].coefficient * terms_[b].coefficient;
      for (int k = 0; k < 9; ++k) {
        const std::int32_t target = blocks_[block][k];
        if (target >= 0) add(target, factor * tangent(k / 3, k % 3));
      }
    }
  }
}

}  // namespace lipofill::solid
