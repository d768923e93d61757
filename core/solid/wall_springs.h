#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/solid/node_blocks.h"
#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// A spring between two points of the tissue, each the weighted mean of four nodes (weights 1, 0,
/// 0, 0: one node). The nodes need not share a hexahedron: springs span films.
struct WallSpring {
  std::array<int, 4> outer;
  std::array<int, 4> inner;
  std::array<double, 4> weight;  ///< of the nodes of both points; they add up to 1
  double stiffness;              ///< k [N/m] > 0
  double slack = 0.0;            ///< [m] >= 0
};

/// Groups of nodes that springs couple with one another: those of each spring whose weight is not
/// zero.
std::vector<std::vector<int>> collect_coupled_nodes(const std::vector<WallSpring>& springs);

/// The part of a spring that changes.
struct WallSpringState {
  bool intact = true;
  double tension = 0.0;  ///< [N]
  double length = 0.0;   ///< distance between the two points [m]
};

/// Springs that pull but never push, from d = x_outer - x_inner, with L* = |d| at rest + slack:
///
///     f = k (|d| - L*)_+ n,   n = d/|d|              on the inner point; -f on the outer point  [N]
///     energy = 1/2 k (|d| - L*)_+^2                                                             [J]
///     tangent = k n n^T + k (1 - L*/|d|) (I - n n^T)   while taut, else 0: positive semi-definite
///
/// When L* is zero (walls that touch, no slack) this is the linear spring f = k d with tangent k I,
/// which needs no rest direction; rest lengths below a billionth of the tissue's extent count as
/// zero. A broken spring carries nothing. The part along n belongs to K (Rayleigh damping acts on
/// it), the part across to K_G (tissue.h). Constant and shared; what changes of a spring is a
/// WallSpringState. Checked by tests/unit/solid/wall_springs_test.cc.
class WallSprings {
 public:
  /// The springs have been checked (tissue_checks.h); their nodes are coupled in `pattern`.
  WallSprings(const std::vector<WallSpring>& springs, const Eigen::Matrix3Xd& rest, const SystemPattern& pattern);

  /// Brings tension and length of each spring to the positions `x` and adds what they pull to
  /// `force`; returns the energy [J]. Both have four numbers a node, the last of no meaning.
  /// Allocates nothing, as does add_tangent.
  double add_force(const Eigen::Matrix4Xd& x, std::vector<WallSpringState>& states, Eigen::Matrix4Xd& force) const;
  /// Adds K and K_G at the positions of the last add_force.
  void add_tangent(const Eigen::Matrix4Xd& x, const std::vector<WallSpringState>& states, TangentValues& values) const;

  int size() const { return static_cast<int>(springs_.size()); }

 private:
  struct Spring {
    int first_term, n_terms;  ///< in terms_
    int first_block;          ///< in blocks_: pairs (a, b) of its terms, a >= b
    double stiffness;         ///< k [N/m]
    double taut_length;       ///< L* [m]
  };
  /// d = sum of coefficient times node position.
  struct Term {
    int node;
    double coefficient;
  };
  /// Places in the pattern of the nine values of a pair's block; -1 for none.
  using Block = std::array<std::int32_t, 9>;

  void add_terms(const WallSpring& spring, const SystemPattern& pattern);
  void add_block(const Term& a, const Term& b, const SystemPattern& pattern);
  template <typename Positions>
  Eigen::Vector3d separation(const Spring& spring, const Positions& x) const;
  template <typename Add>
  void scatter(const Spring& spring, const Eigen::Matrix3d& tangent, Add add) const;

  std::vector<Spring> springs_;
  std::vector<Term> terms_;
  std::vector<Block> blocks_;
};

}  // namespace lipofill::solid
