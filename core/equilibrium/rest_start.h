#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "core/equilibrium/parts.h"
#include "core/model/face_model.h"
#include "core/model/shared_parts.h"

namespace lipofill::equilibrium {

/// The first shape on the way from rest, the linear response of the tissue at rest:
///
///     dx0 = S0^-1 r0,   dp = (A S0^-1 A^T)^-1 (V - gap0 - A dx0),   dx = dx0 + S0^-1 A^T dp
///
/// What it takes of the factor at rest is shared by all that have the same tissue, films, springs
/// and load, so that only the first of them factors there. A start is the same bits whoever made
/// it. Checked by tests/unit/equilibrium/equilibrium_test.cc.
class RestStart {
 public:
  /// What is passed here outlives the start.
  RestStart(const model::FaceModel& model, Parts& parts, const StaticLoad& load)
      : model_(model), parts_(parts), load_(load) {}

  /// Brings `shape` from rest to the start for pools of `volume` [m3], and leaves the factor at
  /// rest, or none where it is no use: where the start is far from rest. False when the tissue is
  /// not positive definite at rest.
  /// @param n_factors  counts those that were made
  bool leave(const Eigen::VectorXd& volume, const Eigen::VectorXd& springs, Shape& shape, int& n_factors);

 private:
  bool factor_at_rest(const Eigen::VectorXd& springs, int& n_factors);
  bool know_rest(const Eigen::VectorXd& springs, int& n_factors);
  std::string key(const Eigen::VectorXd& springs) const;
  Shape rest() const { return Shape::at_rest(parts_.system.tissue().n_dofs(), parts_.pools); }

  const model::FaceModel& model_;
  Parts& parts_;
  const StaticLoad load_;
  std::string known_key_;
  std::shared_ptr<const model::RestResponse> known_;
};

}  // namespace lipofill::equilibrium
