#include "core/coupling/coupled_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace lipofill::coupling {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// A stiffness like that of a plate on springs, scaled as tissue in SI is, and a B whose entries
/// are areas.
struct Case {
  Sparse s_lower;
  Sparse b;
  Eigen::MatrixXd s_dense;
  Eigen::MatrixXd b_dense;

  Case(int n, int cells, double stiffness, double area, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.5, 1.5);
    s_dense.setZero(n * n, n * n);
    const auto couple = [&](int a, int c) {
      const double k = stiffness * uniform(random);
      s_dense(a, a) += k;
      s_dense(c, c) += k;
      s_dense(a, c) -= k;
      s_dense(c, a) -= k;
    };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        if (i + 1 < n) couple(j * n + i, j * n + i + 1);
        if (j + 1 < n) couple(j * n + i, (j + 1) * n + i);
        if (i == 0 || j == 0 || i + 1 == n || j + 1 == n) s_dense(j * n + i, j * n + i) += stiffness;
      }
    }
    b_dense.setZero(cells, n * n);
    const int per_cell = n * n / cells;
    for (int cell = 0; cell < cells; ++cell) {
      for (int k = 0; k < per_cell; ++k) b_dense(cell, cell * per_cell + k) = area * uniform(random);
    }
    s_lower = Sparse(s_dense.sparseView()).triangularView<Eigen::Lower>();
    b = b_dense.sparseView();
  }
  Eigen::MatrixXd compliance() const { return b_dense * s_dense.llt().solve(b_dense.transpose()); }
};

constexpr double kBound[] = {2e-5, 1e-12};  ///< float32 and float64 keep to these
const Precision kPrecisions[] = {Precision::kSingle, Precision::kDouble};

double bound_of(Precision precision) {
  return kBound[precision == Precision::kDouble];
}

CoupledFactor analyse(const Sparse& s, const Sparse& b) {
  return CoupledFactor(*FactorAnalysis::create(s, b));
}

double relative_error(const Eigen::MatrixXd& value, const Eigen::MatrixXd& exact) {
  return (value - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

TEST(CoupledFactor, ComplianceEqualsTheDenseOneAtAnyScale) {
  for (const Precision precision : kPrecisions) {
    for (const double stiffness : {1e-3, 1.0, 1e6}) {
      for (const double area : {1e-6, 1.0}) {
        const Case c(12, 9, stiffness, area, 3);
        CoupledFactor factor = analyse(c.s_lower, c.b);
        ASSERT_TRUE(factor.factorise(c.s_lower, c.b, precision));
        EXPECT_LT(relative_error(factor.compliance(), c.compliance()), bound_of(precision));
        EXPECT_EQ(factor.compliance(), factor.compliance().transpose());
        EXPECT_LT(relative_error(factor.lumped_compliance(), c.compliance().rowwise().sum()), bound_of(precision));
      }
    }
  }
}

TEST(CoupledFactor, SolvesEqualTheDenseOnes) {
  const Case c(15, 20, 1e4, 1e-5, 5);
  const Sparse no_cells(0, c.b.cols());
  for (const Precision precision : kPrecisions) {
    for (const Sparse& pressures_in_factor : {c.b, no_cells}) {
      CoupledFactor factor = analyse(c.s_lower, pressures_in_factor);
      ASSERT_TRUE(factor.factorise(c.s_lower, c.b, precision));
      const Eigen::VectorXd r = Eigen::VectorXd::Random(c.s_dense.rows());
      const Eigen::VectorXd p = 1e3 * Eigen::VectorXd::Random(c.b_dense.rows());
      Eigen::VectorXd response, dx;
      factor.solve_gap_response(r, response);
      EXPECT_LT(relative_error(response, c.b_dense * c.s_dense.llt().solve(r)), bound_of(precision));
      factor.solve_displacement(p, dx);
      EXPECT_LT(relative_error(dx, c.s_dense.llt().solve(r + c.b_dense.transpose() * p)), bound_of(precision));
    }
  }
}

/// Several at once: whole groups, and what is left of one, with pressures in the factor or without.
TEST(CoupledFactor, SolvesManyAsOneByOne) {
  const Case c(15, 20, 1e4, 1e-5, 5);
  const Sparse no_cells(0, c.b.cols());
  for (const Precision precision : kPrecisions) {
    for (const Sparse& pressures_in_factor : {c.b, no_cells}) {
      CoupledFactor factor = analyse(c.s_lower, pressures_in_factor);
      ASSERT_TRUE(factor.factorise(c.s_lower, pressures_in_factor, precision));
      for (const int n : {1, 7, 8, 9, 16, 21}) {
        SCOPED_TRACE(n);
        const Eigen::MatrixXd r = Eigen::MatrixXd::Random(c.s_dense.rows(), n);
        Eigen::MatrixXd x, again;
        factor.solve_many(r, x);
        ASSERT_EQ(x.cols(), n);
        EXPECT_LT((c.s_dense * x - r).norm() / r.norm(), bound_of(precision));
        factor.solve_many(r.rightCols(1), again);
        EXPECT_EQ(again.col(0), x.col(n - 1)) << "whatever is beside it";
      }
    }
  }
}

TEST(CoupledFactor, WithoutPressuresInItMultipliesByTheCompliance) {
  const Case c(12, 9, 1e4, 1e-5, 7);
  CoupledFactor factor = analyse(c.s_lower, Sparse(0, c.b.cols()));
  EXPECT_FALSE(factor.has_compliance());
  for (const Precision precision : kPrecisions) {
    ASSERT_TRUE(factor.factorise(c.s_lower, c.b, precision));
    const Eigen::VectorXd p = Eigen::VectorXd::Random(9);
    Eigen::VectorXd product;
    factor.multiply_compliance(p, product);
    EXPECT_LT(relative_error(product, c.compliance() * p), bound_of(precision));
    EXPECT_LT(relative_error(factor.lumped_compliance(), c.compliance().rowwise().sum()), bound_of(precision));
  }
}

TEST(CoupledFactor, FollowsValuesThatChangeByOrdersOfMagnitude) {
  const Case soft(10, 10, 1.0, 1.0, 1);
  const Case stiff(10, 10, 1e5, 1.0, 1);
  CoupledFactor factor = analyse(soft.s_lower, soft.b);
  for (const Case* c : {&stiff, &soft, &stiff}) {
    ASSERT_TRUE(factor.factorise(c->s_lower, c->b, Precision::kSingle));
    EXPECT_LT(relative_error(factor.compliance(), c->compliance()), bound_of(Precision::kSingle));
  }
}

TEST(CoupledFactor, RefusesAnIndefiniteTissue) {
  const Case c(10, 10, 1.0, 1.0, 2);
  CoupledFactor factor = analyse(c.s_lower, c.b);
  Sparse broken = c.s_lower;
  broken.coeffRef(40, 40) = -5.0;
  for (const Precision precision : kPrecisions) {
    EXPECT_FALSE(factor.factorise(broken, c.b, precision));
    EXPECT_TRUE(factor.factorise(c.s_lower, c.b, precision));
  }
}

TEST(CoupledFactor, NeedsFloat64WhereFloat32HasNoPivot) {
  // A chain held by a spring a million times softer than a link's rounding in float32 would need.
  const int n = 400;
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k + 1 < n; ++k) {
    s(k, k) += 1.0;
    s(k + 1, k + 1) += 1.0;
    s(k, k + 1) -= 1.0;
    s(k + 1, k) -= 1.0;
  }
  s(0, 0) += 1e-10;
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(1, n);
  b(0, n - 1) = 1.0;
  const Sparse s_lower = Sparse(s.sparseView()).triangularView<Eigen::Lower>();
  const Sparse b_sparse = b.sparseView();
  CoupledFactor factor = analyse(s_lower, b_sparse);
  const bool is_single_good = factor.factorise(s_lower, b_sparse, Precision::kSingle) &&
                              relative_error(factor.compliance(), b * s.llt().solve(b.transpose())) < 0.1;
  EXPECT_FALSE(is_single_good);
  ASSERT_TRUE(factor.factorise(s_lower, b_sparse, Precision::kDouble));
  EXPECT_LT(relative_error(factor.compliance(), b * s.llt().solve(b.transpose())), 1e-4);
}

TEST(CoupledFactor, KnowsItsMemoryBeforeItFactors) {
  // At most the whole triangle twice over (supernodes are padded), at least the triangle of S
  // itself.
  const Case c(12, 9, 1.0, 1.0, 6);
  const auto analysis = *FactorAnalysis::create(c.s_lower, c.b);
  const auto n = static_cast<double>(c.s_dense.rows() + 9);
  EXPECT_GE(analysis->n_values(), c.s_lower.nonZeros() + c.b.nonZeros());
  EXPECT_LE(static_cast<double>(analysis->n_values()), n * n);
}

TEST(CoupledFactor, WorksOnTissueInPieces) {
  // Two tissues that only a cell's pressure joins: the elimination tree of S is a forest.
  const Case c(6, 4, 1.0, 1.0, 4);
  const Eigen::Index n = c.s_dense.rows();
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  s.topLeftCorner(n, n) = s.bottomRightCorner(n, n) = c.s_dense;
  Eigen::MatrixXd b(4, 2 * n);
  b << c.b_dense, -c.b_dense;
  const Sparse s_lower = Sparse(s.sparseView()).triangularView<Eigen::Lower>();
  const Sparse b_sparse = b.sparseView();
  CoupledFactor factor = analyse(s_lower, b_sparse);
  for (const Precision precision : kPrecisions) {
    ASSERT_TRUE(factor.factorise(s_lower, b_sparse, precision));
    EXPECT_LT(relative_error(factor.compliance(), b * s.llt().solve(b.transpose())), bound_of(precision));
  }
}

TEST(CoupledFactor, TwoOfOneAnalysisDoNotDisturbEachOther) {
  const Case first(12, 9, 1e4, 1e-5, 1);
  const Case second(12, 9, 1e3, 1e-5, 2);
  const auto analysis = *FactorAnalysis::create(first.s_lower, first.b);
  CoupledFactor a(analysis), b(analysis);
  ASSERT_TRUE(a.factorise(first.s_lower, first.b, Precision::kDouble));
  ASSERT_TRUE(b.factorise(second.s_lower, second.b, Precision::kDouble));
  EXPECT_LT(relative_error(a.compliance(), first.compliance()), 1e-12);
  EXPECT_LT(relative_error(b.compliance(), second.compliance()), 1e-12);
}

}  // namespace
}  // namespace lipofill::coupling
