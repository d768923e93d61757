#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/forecast/forecast.h"
#include "core/simulation/plan_ensemble.h"

namespace lipofill::forecast {

/// The members of an ensemble, drawn.
struct Design {
  Eigen::MatrixXd standard;       ///< variables of the polynomials (n, inputs)
  Eigen::MatrixXd values;         ///< of the inputs (n, inputs)
  std::vector<bool> is_gaussian;  ///< an input
};

/// Sobol's points through the inverse of each distribution.
Design draw_design(const std::vector<UncertainInput>& inputs, int members);

/// The table holds what came of the members that settled, in their order.
struct MemberTable {
  std::vector<int> settled;                                  ///< their rows in the design
  std::vector<MemberFailure> failures;                       ///< of the others
  std::vector<std::vector<simulation::MemberShape>> shapes;  ///< a member, a time; without their skin
  std::vector<Eigen::Matrix3Xd> skin_sum;                    ///< a time: displacements added up [m]
  std::vector<Eigen::MatrixXf> lift;  ///< a time: length of the displacement [m] (members, nodes)
};

/// Finds the members part by part.
/// @param months  of the times, the first 0
/// @param fields  with skin_sum and lift
absl::StatusOr<MemberTable> run_members(simulation::PlanEnsemble& ensemble, const model::FaceModel& model,
                                        const plan::SimulationSpec& plan, const std::vector<UncertainInput>& inputs,
                                        const Design& design, const Retention& retention,
                                        const std::vector<double>& months, bool fields, const KeptParts& kept,
                                        const geometry::Progress& progress);

/// A field of displacements whose zones lie farther along the chart [m]: the value of a node is
/// that of the place from which it was moved, with distances as they are at the node.
/// Checked by tests/unit/forecast/member_run_test.cc.
Eigen::Matrix3Xf move_over_skin(const geometry::LayeredGrid& grid, const Eigen::Matrix3Xf& field, double along_xi,
                                double along_eta);

}  // namespace lipofill::forecast
