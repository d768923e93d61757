// Sobol indices of Ishigami's function by polynomial chaos, against their closed form.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/forecast/influence.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using forecast::Influences;

constexpr double kA = 7.0;
constexpr double kB = 0.1;
constexpr double kPi = std::numbers::pi;

/// y = sin x1 + a sin^2 x2 + b x3^4 sin x1 on [-pi, pi]^3 (Ishigami & Homma 1990).
Influences find(int members) {
  const Eigen::MatrixXd x = 2.0 * forecast::draw_points(members, 3).array() - 1.0;
  Eigen::VectorXd y(members);
  for (int k = 0; k < members; ++k) {
    const double x1 = kPi * x(k, 0), x2 = kPi * x(k, 1), x3 = kPi * x(k, 2);
    y[k] = std::sin(x1) + kA * std::pow(std::sin(x2), 2) + kB * std::pow(x3, 4) * std::sin(x1);
  }
  return forecast::find_influences(x, {false, false, false}, y);
}

struct Exact {
  double first[3], total[3];
};

Exact exact() {
  const double v1 = 0.5 * std::pow(1.0 + kB * std::pow(kPi, 4) / 5.0, 2);
  const double v2 = kA * kA / 8.0;
  const double v13 = kB * kB * std::pow(kPi, 8) * (1.0 / 18.0 - 1.0 / 50.0);
  const double all = v1 + v2 + v13;
  return {{v1 / all, v2 / all, 0.0}, {(v1 + v13) / all, v2 / all, v13 / all}};
}

double largest_error(const Influences& found) {
  const Exact expected = exact();
  double error = 0.0;
  for (int k = 0; k < 3; ++k) {
    error = std::max({error, std::abs(found.of_input[k].first_order - expected.first[k]),
                      std::abs(found.of_input[k].total - expected.total[k])});
  }
  return error;
}

const CaseInfo kInfo = {"forecast/1-ishigami", "Sobol indices of Ishigami's function",
                        "Closed forms of its variance (Ishigami & Homma 1990), a = 7, b = 0.1."};

TEST(Ishigami, IndicesAreThoseOfTheClosedForm) {
  Case ishigami(kInfo);
  const Influences found = find(1000);
  const Exact expected = exact();
  for (int k = 0; k < 3; ++k) {
    ishigami.record({with_number("1000 members: S%g", k + 1), "1", expected.first[k], found.of_input[k].first_order,
                     0.01, Bound::kAbsolute});
    ishigami.record({with_number("1000 members: T%g", k + 1), "1", expected.total[k], found.of_input[k].total, 0.01,
                     Bound::kAbsolute});
  }
  ishigami.record({"1000 members: unexplained share", "1", 0.01, found.unexplained, 0.0, Bound::kAtMost});
}

TEST(Ishigami, IndicesConvergeWithTheMembers) {
  Case ishigami(kInfo);
  const std::vector<double> members = {100, 200, 400, 800};
  std::vector<double> errors;
  for (const double n : members) errors.push_back(largest_error(find(static_cast<int>(n))));
  for (size_t k = 0; k < members.size(); ++k) {
    ishigami.record(
        {with_number("%g members: largest error of an index", members[k]), "1", 0.0, errors[k], 0.0, Bound::kReported});
  }
  ishigami.record({"100 over 800 members: ratio of the largest errors", "1", 10.0, errors.front() / errors.back(), 0.0,
                   Bound::kAtLeast});
}

TEST(Ishigami, ErrorsOfTheIndicesAreOfTheirSize) {
  const Influences found = find(400);
  const Exact expected = exact();
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.of_input[k].first_order, expected.first[k], 0.005 + 4.0 * found.of_input[k].first_order_error);
    EXPECT_LT(found.of_input[k].first_order_error, 0.1);
  }
}

}  // namespace
}  // namespace lipofill::verification
