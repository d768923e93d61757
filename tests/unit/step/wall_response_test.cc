// How the walls of films answer to pressure: each kind by its formula, and all of them together.

#include "core/step/wall_response.h"

#include "tests/unit/mechanics/small_system.h"

namespace lipofill::step {
namespace {

using mechanics::SmallSystem;
using plan::CouplingMode;

constexpr double kStiffness = 2e6;         ///< of the Winkler walls [Pa/m]
constexpr double kCellArea = 8e-3 * 8e-3;  ///< [m2]
constexpr double kLeastOwnShare = 1e-3;    ///< of its own compliance that a lumped cell keeps

/// The tissue of the small plan, factored where it is bent; films may be added that have walls of
/// their own.
struct Case : SmallSystem {
  std::vector<plan::FilmLayout> all = films;
  mechanics::FilmCells all_cells;
  std::unique_ptr<mechanics::FilmGeometry> geometry;

  explicit Case(const std::vector<plan::FilmWallKind>& others = {}) {
    for (const plan::FilmWallKind wall : others) {
      all.push_back(films[0]);
      all.back().wall = wall;
      all.back().wall_stiffness = kStiffness;
    }
    all_cells = mechanics::number_cells(all);
    geometry = std::make_unique<mechanics::FilmGeometry>(model->geometry.grid, all, all_cells, system.get());
    mechanics::SimulationState state = state_at(bent(1e-3));
    EXPECT_TRUE(factor->renew(0.01, state));
  }

  WallResponse make(CouplingMode coupling) { return {all, all_cells, *geometry, coupling, &factor->factor()}; }
  /// C 1 of the tissue, but no less than a share of C's diagonal.
  Eigen::VectorXd lumped() const {
    const Eigen::MatrixXd& C = factor->factor().compliance();
    return (C * Eigen::VectorXd::Ones(C.rows())).cwiseMax(kLeastOwnShare * C.diagonal());
  }
};

TEST(WallResponse, RestVolumeIsAreaTimesThicknessAtTheCentre) {
  SmallSystem c;
  c.films[0].wall = plan::FilmWallKind::kRigid;
  c.films[0].rest_thickness = geometry::ScalarField{2, 1, {1e-3, 3e-3}};  // linear in xi
  const mechanics::FilmCells cells = mechanics::number_cells(c.films);
  const mechanics::FilmGeometry geometry(c.model->geometry.grid, c.films, cells, nullptr);
  const WallResponse walls(c.films, cells, geometry, CouplingMode::kExact, nullptr);
  for (const int cell : {0, 4, 35}) {
    const double xi = (cell % 6 + 0.5) / 6.0;
    EXPECT_NEAR(walls.rest_volume()[cell], kCellArea * (1e-3 + 2e-3 * xi), 1e-20);
  }
}

TEST(WallResponse, WallsOfTheirOwnAreSpringsOrDoNotGiveWay) {
  SmallSystem c;
  std::vector<plan::FilmLayout> films(2, c.films[0]);
  films[0].wall = plan::FilmWallKind::kWinkler;
  films[0].wall_stiffness = kStiffness;
  films[1].wall = plan::FilmWallKind::kRigid;
  const mechanics::FilmCells cells = mechanics::number_cells(films);
  const mechanics::FilmGeometry geometry(c.model->geometry.grid, films, cells, nullptr);
  WallResponse walls(films, cells, geometry, CouplingMode::kExact, nullptr);
  walls.update();
  EXPECT_FALSE(walls.is_implicit());
  EXPECT_EQ(walls.compliance().dense, nullptr);
  EXPECT_EQ(walls.compliance().tissue, nullptr);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(72);
  expected.head(36).setConstant(kCellArea / kStiffness);
  EXPECT_LT((walls.compliance().diagonal - expected).cwiseAbs().maxCoeff(), 1e-13 * kCellArea / kStiffness);

  const Eigen::VectorXd pressure = Eigen::VectorXd::LinSpaced(72, -500.0, 2000.0);
  Eigen::VectorXd gap;
  walls.compute_gap_of_own_walls(pressure, gap);
  const Eigen::VectorXd change = gap - walls.rest_volume();
  EXPECT_LT((change - expected.cwiseProduct(pressure)).cwiseAbs().maxCoeff(), 1e-20);
}

TEST(WallResponse, TissueAloneGivesItsComplianceAsItIs) {
  Case c;
  WallResponse walls = c.make(CouplingMode::kExact);
  walls.update();
  EXPECT_EQ(walls.compliance().dense, &c.factor->factor().compliance());
  const Eigen::VectorXd lumped = c.lumped();
  EXPECT_LT((walls.compliance().diagonal - lumped).norm(), 1e-5 * lumped.norm());
}

TEST(WallResponse, LumpedTissueHasNoMoreThanADiagonal) {
  Case c({plan::FilmWallKind::kWinkler});
  WallResponse walls = c.make(CouplingMode::kLumped);
  walls.update();
  EXPECT_EQ(walls.compliance().dense, nullptr);
  EXPECT_EQ(walls.compliance().tissue, nullptr);
  const Eigen::VectorXd lumped = c.lumped();
  EXPECT_LT((walls.compliance().diagonal.head(36) - lumped).norm(), 1e-5 * lumped.norm());
  EXPECT_NEAR(walls.compliance().diagonal[40], kCellArea / kStiffness, 1e-13 * kCellArea / kStiffness);
}

TEST(WallResponse, FilmsOfBothKindsStandInOneMatrix) {
  Case c({plan::FilmWallKind::kWinkler, plan::FilmWallKind::kRigid});
  WallResponse walls = c.make(CouplingMode::kExact);
  walls.update();
  ASSERT_NE(walls.compliance().dense, nullptr);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(108, 108);
  expected.topLeftCorner(36, 36) = c.factor->factor().compliance();
  expected.diagonal().segment(36, 36) = c.geometry->rest_area(1) / kStiffness;
  EXPECT_EQ(*walls.compliance().dense, expected);
}

/// Too many cells for a dense C: then it is known by its products alone, and a lumped cell keeps a
/// share of the mean.
TEST(WallResponse, AFactorWithoutPressuresIsUsedByItsProducts) {
  Case c;
  const Eigen::SparseMatrix<double>& s = c.system->tissue().system_matrix();
  const Eigen::SparseMatrix<double>& b = c.system->gaps().derivative();
  coupling::CoupledFactor factor(
      *coupling::FactorAnalysis::create(s, Eigen::SparseMatrix<double>(0, static_cast<Eigen::Index>(b.cols()))));
  ASSERT_TRUE(factor.factorise(s, b, coupling::Precision::kDouble));
  WallResponse walls(c.all, c.all_cells, *c.geometry, CouplingMode::kExact, &factor);
  walls.update();
  EXPECT_TRUE(walls.is_implicit());
  EXPECT_EQ(walls.compliance().dense, nullptr);
  EXPECT_EQ(walls.compliance().tissue, &factor);
  EXPECT_EQ(*walls.compliance().tissue_cells, c.all_cells.on_tissue);
  const Eigen::MatrixXd& C = c.factor->factor().compliance();
  const Eigen::VectorXd lumped = C * Eigen::VectorXd::Ones(36);
  const Eigen::VectorXd expected = lumped.cwiseMax(kLeastOwnShare * lumped.mean());
  EXPECT_LT((walls.compliance().diagonal - expected).norm(), 1e-4 * expected.norm());
}

TEST(WallResponse, TheGapErrorIsOfCellsOrLumpedOfTheSum) {
  Case c;
  coupling::FilmSolution solution;
  solution.volume = Eigen::VectorXd::Constant(36, 1e-8);
  solution.void_volume = Eigen::VectorXd::Zero(36);
  solution.void_volume[3] = 4e-8;
  Eigen::VectorXd gap = solution.volume + solution.void_volume;
  gap[0] += 3e-9;
  gap[1] -= 1e-9;
  const double held = 36e-8 + 4e-8;
  EXPECT_NEAR(c.make(CouplingMode::kExact).relative_gap_error(gap, solution), 4e-9 / held, 1e-12);
  EXPECT_NEAR(c.make(CouplingMode::kLumped).relative_gap_error(gap, solution), 2e-9 / held, 1e-12);
}

}  // namespace
}  // namespace lipofill::step
