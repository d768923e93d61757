#include "core/solid/wall_springs.h"

#include <algorithm>
#include <map>

namespace lipofill::solid {
namespace {

/// Rest lengths below this share of the tissue's extent are round-off of walls that touch.
constexpr double kTouchingShare = 1e-9;
/// A spring this near to its length counts as taut in the tangent, so that round-off at rest decides nothing.
constexpr double kTautShare = 1.0 - 1e-9;

/// Coefficients of the nodes in d = x_outer - x_inner, nodes ascending, those of weight zero left out.
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
  added.intact = true;
  added.first_term = static_cast<int>(terms_.size());
  added.first_block = static_cast<int>(blocks_.size());
  for (const auto& [node, coefficient] : collect_coefficients(spring)) {
    const std::vector<int>& dofs = pattern.dof_of_component();
    terms_.push_back({node, coefficient, {dofs[3 * node], dofs[3 * node + 1], dofs[3 * node + 2]}});
    for (size_t b = added.first_term; b < terms_.size(); ++b) add_block(terms_.back(), terms_[b], pattern);
  }
  added.n_terms = static_cast<int>(terms_.size()) - added.first_term;
  springs_.push_back(added);
}

void WallSprings::add_block(const Term& a, const Term& b, const SystemPattern& pattern) {
  Block block;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const bool kept = a.dof[i] >= 0 && b.dof[j] >= 0 && (a.node != b.node || i >= j);
      block[3 * i + j] = kept ? pattern.find(a.dof[i], b.dof[j]) : -1;
    }
  }
  blocks_.push_back(block);
}

Eigen::Vector3d WallSprings::separation(const Spring& spring, const Eigen::Matrix3Xd& x) const {
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
  for (int a = spring.first_term; a < spring.first_term + spring.n_terms; ++a) {
    d += terms_[a].coefficient * x.col(terms_[a].node);
  }
  return d;
}

double WallSprings::add(const Eigen::Matrix3Xd& x, Eigen::VectorXd& stiffness, Eigen::VectorXd& geometric,
                        Eigen::VectorXd& force) {
  double energy = 0.0;
  for (Spring& spring : springs_) {
    const Eigen::Vector3d d = separation(spring, x);
    spring.length = d.norm();
    const double stretch = spring.intact ? std::max(0.0, spring.length - spring.taut_length) : 0.0;
    spring.tension = spring.stiffness * stretch;
    energy += 0.5 * spring.tension * stretch;
    if (!spring.intact || spring.length < kTautShare * spring.taut_length) continue;
    if (spring.taut_length == 0.0) {
      scatter(spring, spring.stiffness * Eigen::Matrix3d::Identity(), stiffness);
    } else {
      const Eigen::Vector3d n = d / spring.length;
      const Eigen::Matrix3d along = n * n.transpose();
      scatter(spring, spring.stiffness * along, stiffness);
      scatter(spring, spring.tension / spring.length * (Eigen::Matrix3d::Identity() - along), geometric);
    }
    if (spring.tension == 0.0) continue;
    for (int a = spring.first_term; a < spring.first_term + spring.n_terms; ++a) {
      for (int c = 0; c < 3; ++c) {
        const int dof = terms_[a].dof[c];
        if (dof >= 0) force[dof] += terms_[a].coefficient * spring.tension * d[c] / spring.length;
      }
    }
  }
  return energy;
}

void WallSprings::scatter(const Spring& spring, const Eigen::Matrix3d& tangent, Eigen::VectorXd& values) const {
  int block = spring.first_block;
  for (int a = spring.first_term; a < spring.first_term + spring.n_terms; ++a) {
    for (int b = spring.first_term; b <= a; ++b, ++block) {
      const double factor = terms_[a].coefficient * terms_[b].coefficient;
      for (int k = 0; k < 9; ++k) {
        const std::int32_t target = blocks_[block][k];
        if (target >= 0) values[target] += factor * tangent(k / 3, k % 3);
      }
    }
  }
}

}  // namespace lipofill::solid
