#include "core/coupling/panel_solve.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

namespace lipofill::coupling {
namespace {

template <typename Scalar>
class PanelSolveTest : public testing::Test {
 protected:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  static constexpr int kPadding = PanelSolve<Scalar>::kPadding;
  static constexpr double kTolerance = 50.0 * std::numeric_limits<Scalar>::epsilon();

  /// A panel as it is stored: what is above the diagonal and behind the last column has no meaning.
  void make(int n_rows, int n_columns) {
    stored_ = random(n_rows * n_columns + kPadding);
    panel_ = Eigen::Map<Matrix>(stored_.data(), n_rows, n_columns);
    for (int c = 0; c < n_columns; ++c) panel_(c, c) = Scalar(2 + c % 3);
    panel_ /= Scalar(n_rows);
    panel_.diagonal() *= Scalar(n_rows);
    Eigen::Map<Matrix>(stored_.data(), n_rows, n_columns) = panel_;
    PanelSolve<Scalar>::invert_diagonal(stored_.data(), n_rows, n_columns);
  }
  /// Every remainder of the columns by four and of the rows by a cache line.
  template <typename Check>
  void for_each_size(Check check) {
    for (const int n_rows : {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 33, 64, 200}) {
      for (const int n_columns : {1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 64, 200}) {
        if (n_columns > n_rows) continue;
        SCOPED_TRACE(testing::Message() << n_rows << " x " << n_columns);
        make(n_rows, n_columns);
        check(n_rows, n_columns, random(n_rows));
      }
    }
  }
  static Vector pad(Vector t, Scalar padding) {
    t.conservativeResize(t.size() + kPadding);
    t.tail(kPadding).setConstant(padding);
    return t;
  }
  Vector random(int n) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    return Vector::NullaryExpr(n, [&] { return static_cast<Scalar>(uniform(generator_)); });
  }
  Eigen::MatrixXd triangle() const {
    return panel_.topRows(panel_.cols()).template cast<double>().template triangularView<Eigen::Lower>();
  }
  Eigen::MatrixXd below() const { return panel_.bottomRows(panel_.rows() - panel_.cols()).template cast<double>(); }
  PanelSolve<Scalar> solve() const {
    return {stored_.data(), static_cast<int>(panel_.rows()), static_cast<int>(panel_.cols())};
  }

  std::mt19937 generator_{7};
  Vector stored_;
  Matrix panel_;
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PanelSolveTest, Scalars);

TYPED_TEST(PanelSolveTest, ForwardIsThatOfDenseAlgebra) {
  this->for_each_size([this](int n_rows, int n_columns, const auto& right) {
    auto t = this->pad(right, TypeParam(1));
    this->solve().forward(t.data());
    const Eigen::VectorXd exact = right.template cast<double>();
    const Eigen::VectorXd top = this->triangle().template triangularView<Eigen::Lower>().solve(exact.head(n_columns));
    const Eigen::VectorXd bottom = exact.tail(n_rows - n_columns) - this->below() * top;
    EXPECT_LE((t.head(n_columns).template cast<double>() - top).norm(), this->kTolerance * top.norm());
    EXPECT_LE((t.segment(n_columns, n_rows - n_columns).template cast<double>() - bottom).norm(),
              this->kTolerance * exact.norm());
  });
}

TYPED_TEST(PanelSolveTest, BackwardIsThatOfDenseAlgebra) {
  this->for_each_size([this](int n_rows, int n_columns, const auto& right) {
    auto t = this->pad(right, TypeParam(0));
    this->solve().backward(t.data());
    const Eigen::VectorXd exact = right.template cast<double>();
    const Eigen::VectorXd top = this->triangle().transpose().template triangularView<Eigen::Upper>().solve(
        exact.head(n_columns) - this->below().transpose() * exact.tail(n_rows - n_columns));
    EXPECT_LE((t.head(n_columns).template cast<double>() - top).norm(), this->kTolerance * top.norm());
    EXPECT_EQ(t.segment(n_columns, n_rows - n_columns), right.tail(n_rows - n_columns));
  });
}

/// What is above the diagonal and behind the panel may be anything finite.
TYPED_TEST(PanelSolveTest, NeitherWhatIsAboveTheDiagonalNorWhatIsBehindMatters) {
  constexpr int kN = 21;
  this->make(kN, kN);
  typename TestFixture::Vector t = this->random(kN + this->kPadding);
  t.tail(this->kPadding).setZero();
  auto first = t;
  this->solve().forward(first.data());
  first.tail(this->kPadding).setZero();
  this->solve().backward(first.data());
  for (int c = 0; c < kN; ++c) {
    for (int r = 0; r < c; ++r) this->stored_[c * kN + r] = TypeParam(1e6);
  }
  this->stored_.tail(this->kPadding).setConstant(TypeParam(-1e6));
  auto second = t;
  this->solve().forward(second.data());
  second.tail(this->kPadding).setZero();
  this->solve().backward(second.data());
  EXPECT_EQ(first.head(kN), second.head(kN));
}

}  // namespace
}  // namespace lipofill::coupling
