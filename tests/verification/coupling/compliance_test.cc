// The compliance of a real tissue: EXACT against a dense reference made without the solver, LUMPED
// against the row sums of it.

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/coupling/coupled_factor.h"
#include "core/coupling/film_solve.h"
#include "core/mechanics/tissue_setup.h"
#include "core/plan/film_layout.h"
#include "core/step/coupled_step.h"
#include "tests/unit/simulation/small_case.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

/// A small two-layer tissue with one film, bent so that C has no symmetry to hide behind.
struct TissueCase {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  std::vector<plan::FilmLayout> films;
  std::unique_ptr<mechanics::TissueSetup> setup;
  std::unique_ptr<coupling::GapVolume> gap;
  Eigen::Matrix3Xd x;

  TissueCase() {
    films.push_back(*plan::place_film(*model, simulation::make_small_plan().films[0]));
    setup = std::make_unique<mechanics::TissueSetup>(*mechanics::set_up_tissue(*model, films, {}));
    const auto& tissue = setup->tissue;
    gap = std::make_unique<coupling::GapVolume>(model->geometry.grid, setup->walls[0], films[0].grid,
                                                tissue.dof_of_component(), tissue.n_dofs());
    x = tissue.mesh().rest_positions;
    for (Eigen::Index n = 0; n < x.cols(); ++n) {
      x(2, n) += 2e-3 * std::sin(80.0 * x(0, n)) * std::cos(60.0 * x(1, n)) * (1.0 + 30.0 * x(2, n));
    }
    setup->tissue.assemble(x, 0.01);
    gap->evaluate(x);
  }
  coupling::CoupledFactor factor() const {
    const auto& s = setup->tissue.system_matrix();
    coupling::CoupledFactor made(*coupling::FactorAnalysis::create(s, gap->derivative()));
    EXPECT_TRUE(made.factorise(s, gap->derivative(), coupling::Precision::kDouble));
    return made;
  }
  Eigen::MatrixXd dense_compliance() const {
    const Eigen::MatrixXd s = Eigen::MatrixXd(setup->tissue.system_matrix()).selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd b = gap->derivative();
    return b * s.llt().solve(b.transpose());
  }
};

Case make_case() {
  return Case({"coupled/1-compliance", "Compliance of a two-layer tissue seen by its film",
               "C = B S^-1 B^T by a dense Cholesky factorisation."});
}

TEST(Compliance, ExactEqualsTheDenseReference) {
  const TissueCase c;
  coupling::CoupledFactor factor = c.factor();
  const Eigen::MatrixXd reference = c.dense_compliance();
  const double error = (factor.compliance() - reference).cwiseAbs().maxCoeff() / reference.cwiseAbs().maxCoeff();
  make_case().record({"EXACT: difference from the dense reference", "1", 1e-12, error, 0.0, Bound::kAtMost});
}

TEST(Compliance, LumpedRowSumsKeepTheTotalVolumeAnyPressureMoves) {
  // R_ii = sum_j C_ij, so that 1^T R p = 1^T C p for any p (C is symmetric).
  const TissueCase c;
  const Eigen::MatrixXd reference = c.dense_compliance();
  coupling::CoupledFactor factor = c.factor();
  const Eigen::VectorXd lumped = factor.compliance().rowwise().sum();
  const double rows = (lumped - reference.rowwise().sum()).cwiseAbs().maxCoeff() / lumped.cwiseAbs().maxCoeff();
  const Eigen::VectorXd p = Eigen::VectorXd::Random(lumped.size());
  const double volume = (lumped.dot(p) - (reference * p).sum()) / lumped.cwiseAbs().dot(p.cwiseAbs());
  Case compliance = make_case();
  compliance.record({"LUMPED: difference from the row sums", "1", 1e-11, rows, 0.0, Bound::kAtMost});
  compliance.record({"LUMPED: difference in the volume a pressure moves", "1", 1e-11, volume, 0.0, Bound::kAtMost});
}

TEST(Compliance, DryCellsAreHeldShutByTheSmallestEigenvalue) {
  // With film cells twice as coarse as the wall there is no checkerboard of pressure that no wall
  // feels: without any fluid, J = 0, C alone is definite.
  const TissueCase c;
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(c.dense_compliance()).eigenvalues();
  make_case().record({"smallest eigenvalue of C over the largest", "1", 1e-5,
                      eigenvalues.minCoeff() / eigenvalues.maxCoeff(), 0.0, Bound::kAtLeast});
}

}  // namespace
}  // namespace lipofill::verification
