#include "core/forecast/influence.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace lipofill::forecast {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Strata of the hyperbolic set at most, and products to select from at most, as a share of the
/// members.
constexpr int kMaxStratum = 40;
constexpr double kProductsShare = 0.5;
/// Draws of the members for the errors.
constexpr int kDraws = 100;
/// A figure that varies by less than this share of its size does not vary.
constexpr double kLeastVariation = 1e-9;

int choose_stratum(int inputs, Index members) {
  int stratum = 1;
  while (stratum < kMaxStratum && count_terms(inputs, stratum + 1) <= kProductsShare * static_cast<double>(members)) {
    ++stratum;
  }
  return stratum;
}

double evaluate(const Term& term, const std::vector<bool>& is_gaussian, const MatrixXd& standard, Index member) {
  double product = 1.0;
  for (size_t k = 0; k < term.size(); ++k) {
    if (term[k] == 0) continue;
    product *= orthonormal_polynomial(is_gaussian[k], term[k], standard(member, static_cast<Index>(k)));
  }
  return product;
}

MatrixXd evaluate_all(const std::vector<Term>& terms, const std::vector<bool>& is_gaussian, const MatrixXd& standard) {
  MatrixXd values(standard.rows(), static_cast<Index>(terms.size()));
  for (Index member = 0; member < standard.rows(); ++member) {
    for (size_t k = 0; k < terms.size(); ++k) {
      values(member, static_cast<Index>(k)) = evaluate(terms[k], is_gaussian, standard, member);
    }
  }
  return values;
}

struct Indices {
  VectorXd first, total;
};

/// S and T of each input from the coefficients.
Indices indices_of(const std::vector<Term>& terms, const VectorXd& coefficients, size_t inputs) {
  Indices found{VectorXd::Zero(static_cast<Index>(inputs)), VectorXd::Zero(static_cast<Index>(inputs))};
  double variance = 0.0;
  for (size_t k = 0; k < terms.size(); ++k) {
    const double part = coefficients[static_cast<Index>(k)] * coefficients[static_cast<Index>(k)];
    const auto n_inputs = std::count_if(terms[k].begin(), terms[k].end(), [](int degree) { return degree > 0; });
    if (n_inputs == 0) continue;
    variance += part;
    for (size_t input = 0; input < inputs; ++input) {
      if (terms[k][input] == 0) continue;
      found.total[static_cast<Index>(input)] += part;
      if (n_inputs == 1) found.first[static_cast<Index>(input)] += part;
    }
  }
  if (variance > 0.0) {
    found.first /= variance;
    found.total /= variance;
  }
  return found;
}

/// Computes what is left of the variance where each member is told by the others: the residuals
/// over one less the diagonal of Psi (Psi^T Psi)^-1 Psi^T.
double leave_one_out(const MatrixXd& values, const VectorXd& figure, const VectorXd& residual) {
  const Eigen::HouseholderQR<MatrixXd> qr(values);
  const MatrixXd q = qr.householderQ() * MatrixXd::Identity(values.rows(), values.cols());
  const VectorXd left = residual.array() / (1.0 - q.rowwise().squaredNorm().array()).max(1e-6);
  return left.squaredNorm() / (figure.array() - figure.mean()).square().sum();
}

/// Standard errors of the indices by fits to members drawn with replacement, the same draws on
/// every machine.
void estimate_errors(const std::vector<Term>& terms, const MatrixXd& values, const VectorXd& figure,
                     Influences& influences) {
  const size_t inputs = influences.of_input.size();
  const Index n = values.rows();
  std::mt19937 random(20'180'817);
  MatrixXd drawn(n, values.cols()), sums = MatrixXd::Zero(static_cast<Index>(inputs), 4);
  VectorXd of_drawn(n);
  for (int draw = 0; draw < kDraws; ++draw) {
    for (Index row = 0; row < n; ++row) {
      const auto member = static_cast<Index>(random() % static_cast<unsigned>(n));
      drawn.row(row) = values.row(member);
      of_drawn[row] = figure[member];
    }
    const VectorXd coefficients = (drawn.transpose() * drawn).ldlt().solve(drawn.transpose() * of_drawn);
    const Indices found = indices_of(terms, coefficients, inputs);
    sums.col(0) += found.first;
    sums.col(1) += found.first.cwiseAbs2();
    sums.col(2) += found.total;
    sums.col(3) += found.total.cwiseAbs2();
  }
  const auto error = [](double sum, double squares) {
    return std::sqrt(std::max(0.0, squares - sum * sum / kDraws) / (kDraws - 1));
  };
  for (size_t k = 0; k < inputs; ++k) {
    const auto row = static_cast<Index>(k);
    influences.of_input[k].first_order_error = error(sums(row, 0), sums(row, 1));
    influences.of_input[k].total_error = error(sums(row, 2), sums(row, 3));
  }
}

}  // namespace

/// He and P by their recurrences of three terms.
double orthonormal_polynomial(bool gaussian, int degree, double x) {
  double before = 0.0, last = 1.0, size = 1.0;
  for (int k = 0; k < degree; ++k) {
    const double next = gaussian ? x * last - k * before : ((2 * k + 1) * x * last - k * before) / (k + 1);
    before = last;
    last = next;
    size *= k + 1;
  }
  return gaussian ? last / std::sqrt(size) : last * std::sqrt(2.0 * degree + 1.0);
}

Influences find_influences(const MatrixXd& standard, const std::vector<bool>& is_gaussian, const VectorXd& figure) {
  Influences influences;
  influences.of_input.resize(is_gaussian.size());
  const double scale = std::sqrt((figure.array() - figure.mean()).square().mean());
  if (is_gaussian.empty() || !(scale > kLeastVariation * figure.cwiseAbs().maxCoeff())) return influences;
  const VectorXd scaled = (figure.array() - figure.mean()) / scale;
  const int stratum = choose_stratum(static_cast<int>(is_gaussian.size()), standard.rows());
  const std::vector<Term> terms = select_terms(standard, is_gaussian, scaled, stratum);
  const MatrixXd values = evaluate_all(terms, is_gaussian, standard);
  const VectorXd coefficients = values.colPivHouseholderQr().solve(scaled);
  influences.unexplained = leave_one_out(values, scaled, scaled - values * coefficients);
  const Indices found = indices_of(terms, coefficients, is_gaussian.size());
  for (size_t k = 0; k < is_gaussian.size(); ++k) {
    influences.of_input[k].first_order = found.first[static_cast<Index>(k)];
    influences.of_input[k].total = found.total[static_cast<Index>(k)];
  }
  estimate_errors(terms, values, scaled, influences);
  return influences;
}

}  // namespace lipofill::forecast
