#include "core/coupling/coupled_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace lipofill::coupling {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// A stiffness like that of a plate on springs, scaled as tissue in SI is, and a B whose entries are areas.
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

TEST(CoupledFactor, ComplianceEqualsTheDenseOneAtAnyScale) {
  for (const double stiffness : {1e-3, 1.0, 1e6}) {
    for (const double area : {1e-6, 1.0}) {
      const Case c(12, 9, stiffness, area, 3);
      CoupledFactor factor(c.s_lower, c.b);
      ASSERT_TRUE(factor.factorise(c.s_lower, c.b).ok());
      const Eigen::MatrixXd exact = c.compliance();
      EXPECT_LT((factor.compliance() - exact).cwiseAbs().maxCoeff(), 1e-12 * exact.cwiseAbs().maxCoeff());
      EXPECT_EQ(factor.compliance(), factor.compliance().transpose());
    }
  }
}

TEST(CoupledFactor, SolvesEqualTheDenseOnes) {
  const Case c(15, 20, 1e4, 1e-5, 5);
  CoupledFactor factor(c.s_lower, c.b);
  ASSERT_TRUE(factor.factorise(c.s_lower, c.b).ok());
  const Eigen::VectorXd r = Eigen::VectorXd::Random(c.s_dense.rows());
  const Eigen::VectorXd p = 1e3 * Eigen::VectorXd::Random(c.b_dense.rows());
  const Eigen::VectorXd response = factor.compute_gap_response(r);
  const Eigen::VectorXd exact_response = c.b_dense * c.s_dense.llt().solve(r);
  EXPECT_LT((response - exact_response).norm(), 1e-11 * exact_response.norm());
  const Eigen::VectorXd dx = factor.solve_displacement(r, response, p);
  const Eigen::VectorXd exact = c.s_dense.llt().solve(r + c.b_dense.transpose() * p);
  EXPECT_LT((dx - exact).norm(), 1e-11 * exact.norm());
}

TEST(CoupledFactor, FollowsValuesThatChangeByOrdersOfMagnitude) {
  const Case soft(10, 10, 1.0, 1.0, 1);
  const Case stiff(10, 10, 1e5, 1.0, 1);
  CoupledFactor factor(soft.s_lower, soft.b);
  for (const Case* c : {&stiff, &soft, &stiff}) {
    ASSERT_TRUE(factor.factorise(c->s_lower, c->b).ok());
    const Eigen::MatrixXd exact = c->compliance();
    EXPECT_LT((factor.compliance() - exact).cwiseAbs().maxCoeff(), 1e-12 * exact.cwiseAbs().maxCoeff());
  }
}

TEST(CoupledFactor, RefusesAnIndefiniteTissue) {
  const Case c(10, 10, 1.0, 1.0, 2);
  CoupledFactor factor(c.s_lower, c.b);
  Sparse broken = c.s_lower;
  broken.coeffRef(40, 40) = -5.0;
  EXPECT_FALSE(factor.factorise(broken, c.b).ok());
  EXPECT_TRUE(factor.factorise(c.s_lower, c.b).ok());
}

TEST(CoupledFactor, KnowsItsMemoryBeforeItFactors) {
  // At least the dense block of the pressures, at most the whole triangle twice over (supernodes are padded).
  const Case c(12, 9, 1.0, 1.0, 6);
  const CoupledFactor factor(c.s_lower, c.b);
  const double n = static_cast<double>(c.s_dense.rows()) + 9.0;
  EXPECT_GE(factor.factor_bytes(), 8.0 * 45.0);
  EXPECT_LE(factor.factor_bytes(), 8.0 * n * n);
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
  CoupledFactor factor(s_lower, b_sparse);
  ASSERT_TRUE(factor.factorise(s_lower, b_sparse).ok());
  const Eigen::MatrixXd exact = b * s.llt().solve(b.transpose());
  EXPECT_LT((factor.compliance() - exact).cwiseAbs().maxCoeff(), 1e-12 * exact.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace lipofill::coupling
