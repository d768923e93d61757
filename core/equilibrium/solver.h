#pragma once

#include <Eigen/Core>
#include <string>

#include "core/equilibrium/anderson.h"
#include "core/equilibrium/contact.h"
#include "core/equilibrium/held_response.h"

namespace lipofill::equilibrium {

/// The cost is what an equilibrium took.
struct SolverCost {
  int factors = 0;
  int iterations = 0;  ///< a force, the gaps and a solve each
};

/// Finds the equilibrium of given pool volumes near a shape: iterations with a held factor
/// (held_response.h), accelerated (anderson.h). The factor is renewed at the best shape so far
/// after three iterations that fall slower than they should, or when the forces grow. Cells and
/// pools change their active sets where forces balance. The volumes are made exact in the end.
/// Checked by tests/unit/equilibrium/equilibrium_test.cc.
class Solver {
 public:
  /// What is passed here outlives the solver.
  Solver(StaticBalance& balance, HeldResponse& response, const Pools& pools)
      : Solver(balance, response, pools, own_mixing_) {}
  /// The same with an acceleration that knows of earlier iterations with the factor at hand.
  Solver(StaticBalance& balance, HeldResponse& response, const Pools& pools, AndersonMixing& mixing)
      : balance_(balance), response_(response), pools_(pools), mixing_(mixing) {}
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  /// Improves `shape` until forces balance to `tolerance` (relative, of all that act) and gaps hold
  /// the volumes to round-off; the balance is then there. False, with reason(), when it cannot;
  /// `shape` is then the best one it came by.
  bool solve(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance, Shape& shape);

  const std::string& reason() const { return reason_; }
  const SolverCost& cost() const { return cost_; }

 private:
  bool iterate(const PoolTarget& target, double tolerance, Shape& shape);
  bool advance(Shape& shape);
  bool renew();
  void bring_to(const Shape& shape);
  double measure(const PoolTarget& target, double tolerance, const Shape& shape);
  bool make_volumes_exact(const PoolTarget& target, Shape& shape);

  StaticBalance& balance_;
  HeldResponse& response_;
  const Pools& pools_;
  AndersonMixing own_mixing_;
  AndersonMixing& mixing_;
  SolverCost cost_;
  std::string reason_;
  Eigen::VectorXd springs_;
  double volume_error_ = 0.0;  ///< what the pools lack, share of what they are to hold
  Eigen::VectorXd missing_, dx_, dp_;
  Eigen::VectorXd unknowns_, correction_, next_;  ///< displacement, then pressures
};

}  // namespace lipofill::equilibrium
