// Triangular solves of several right sides: those of one, in every remainder of rows and columns.

#include "core/coupling/panel_solve_many.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

#include "core/coupling/panel_solve.h"

namespace lipofill::coupling {
namespace {

template <typename Scalar>
class PanelSolveManyTest : public testing::Test {
 protected:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr double kTolerance = 50.0 * std::numeric_limits<Scalar>::epsilon();

  /// A lower triangle of moderate condition with rows below it.
  Matrix make_panel(int n_rows, int n_columns) {
    Matrix panel = random(n_rows, n_columns) / Scalar(n_rows);
    for (int c = 0; c < n_columns; ++c) panel(c, c) = Scalar(2 + c % 3);
    return panel;
  }
  Matrix random(int n_rows, int n_columns) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    return Matrix::NullaryExpr(n_rows, n_columns, [&] { return static_cast<Scalar>(uniform(generator_)); });
  }
  Rows forward(const Matrix& panel, Rows t) {
    solver(panel).forward(t.data());
    return t;
  }
  Rows backward(const Matrix& panel, Rows t) {
    solver(panel).backward(t.data());
    return t;
  }

 private:
  PanelSolveMany<Scalar> solver(const Matrix& panel) {
    const auto n_rows = static_cast<int>(panel.rows()), n_columns = static_cast<int>(panel.cols());
    stored_ = panel;
    PanelSolve<Scalar>::invert_diagonal(stored_.data(), n_rows, n_columns);
    return {stored_.data(), n_rows, n_columns};
  }

  std::mt19937 generator_{11};
  Matrix stored_;
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PanelSolveManyTest, Scalars);

TYPED_TEST(PanelSolveManyTest, SolutionsAreThoseOfDenseAlgebra) {
  for (const int n_rows : {1, 2, 3, 4, 5, 8, 9, 17, 64, 130}) {
    for (const int n_columns : {1, 2, 3, 4, 5, 7, 8, 64, 130}) {
      if (n_columns > n_rows) continue;
      SCOPED_TRACE(testing::Message() << n_rows << " x " << n_columns);
      const auto panel = this->make_panel(n_rows, n_columns);
      const Eigen::MatrixXd all = panel.template cast<double>();
      const Eigen::MatrixXd lower = all.topRows(n_columns).template triangularView<Eigen::Lower>();
      const Eigen::MatrixXd below = all.bottomRows(n_rows - n_columns);
      const typename TestFixture::Rows given = this->random(n_rows, 8);
      const Eigen::MatrixXd exact = given.template cast<double>();

      Eigen::MatrixXd expected = exact;
      expected.topRows(n_columns) = lower.triangularView<Eigen::Lower>().solve(exact.topRows(n_columns));
      expected.bottomRows(n_rows - n_columns) -= below * expected.topRows(n_columns);
      const auto forward = this->forward(panel, given);
      EXPECT_LE((forward.template cast<double>() - expected).norm(), this->kTolerance * expected.norm());

      const Eigen::MatrixXd left = exact.topRows(n_columns) - below.transpose() * exact.bottomRows(n_rows - n_columns);
      const Eigen::MatrixXd top = lower.transpose().triangularView<Eigen::Upper>().solve(left);
      const auto backward = this->backward(panel, given);
      EXPECT_LE((backward.topRows(n_columns).template cast<double>() - top).norm(), this->kTolerance * top.norm());
      EXPECT_EQ(backward.bottomRows(n_rows - n_columns), given.bottomRows(n_rows - n_columns));
    }
  }
}

TYPED_TEST(PanelSolveManyTest, ASolutionDoesNotDependOnThoseBesideIt) {
  const auto panel = this->make_panel(57, 22);
  const typename TestFixture::Rows some = this->random(57, 8);
  typename TestFixture::Rows others = this->random(57, 8);
  others.col(3) = some.col(6);
  EXPECT_EQ(this->forward(panel, others).col(3), this->forward(panel, some).col(6));
  EXPECT_EQ(this->backward(panel, others).col(3), this->backward(panel, some).col(6));
}

}  // namespace
}  // namespace lipofill::coupling
