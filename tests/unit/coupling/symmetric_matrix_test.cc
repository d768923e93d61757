#include "core/coupling/symmetric_matrix.h"

#include <gtest/gtest.h>

namespace lipofill::coupling {
namespace {

TEST(SymmetricMatrix, ProductsEqualTheDenseOnesAtAnySizeAndUnit) {
  for (const int n : {1, 3, 4, 5, 8, 13, 64, 131}) {
    for (const double unit : {1e-30, 1.0, 1e40}) {
      const Eigen::MatrixXd r = Eigen::MatrixXd::Random(n, n);
      Eigen::MatrixXd a = r * r.transpose() + Eigen::MatrixXd::Identity(n, n);
      a = unit * a.cast<float>().cast<double>();
      SymmetricMatrix matrix;
      matrix.assign(a);
      const Eigen::VectorXd x = Eigen::VectorXd::Random(n);
      Eigen::VectorXd y;
      matrix.multiply(x, y);
      EXPECT_LT((y - a * x).cwiseAbs().maxCoeff(), 1e-7 * a.cwiseAbs().maxCoeff() * n) << n << " " << unit;
    }
  }
}

TEST(SymmetricMatrix, ReadsTheLowerTriangleAlone) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Random(9, 9);
  a.diagonal().array() += 3.0;
  Eigen::MatrixXd full = a.triangularView<Eigen::Lower>();
  full += Eigen::MatrixXd(a.triangularView<Eigen::StrictlyLower>()).transpose();
  SymmetricMatrix matrix;
  matrix.assign(a);
  Eigen::VectorXd y;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, -1.0, 2.0);
  matrix.multiply(x, y);
  EXPECT_LT((y - full * x).norm(), 1e-6 * full.norm());
}

}  // namespace
}  // namespace lipofill::coupling
