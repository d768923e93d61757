#include "core/forecast/sampling.h"

#include <mutex>
#include <openturns/ComposedDistribution.hxx>
#include <openturns/CorrectedLeaveOneOut.hxx>
#include <openturns/FixedStrategy.hxx>
#include <openturns/FunctionalChaosAlgorithm.hxx>
#include <openturns/HermiteFactory.hxx>
#include <openturns/HyperbolicAnisotropicEnumerateFunction.hxx>
#include <openturns/LARS.hxx>
#include <openturns/LeastSquaresMetaModelSelectionFactory.hxx>
#include <openturns/LeastSquaresStrategy.hxx>
#include <openturns/LegendreFactory.hxx>
#include <openturns/Log.hxx>
#include <openturns/Normal.hxx>
#include <openturns/OrthogonalProductPolynomialFactory.hxx>
#include <openturns/SobolSequence.hxx>
#include <openturns/TBB.hxx>
#include <openturns/Uniform.hxx>

#include "core/coupling/algebra_threads.h"

namespace lipofill::forecast {
namespace {

/// Products of several variables enter later than powers of one.
constexpr double kHyperbolicNorm = 0.75;

std::mutex& turns() {
  static std::mutex mutex;
  return mutex;
}

/// It neither prints nor starts threads of its own, nor does the algebra below it.
void hush() {
  coupling::pin_algebra_to_this_thread();
  OT::Log::Show(OT::Log::NONE);
  OT::TBB::Disable();
}

OT::Sample to_sample(const Eigen::MatrixXd& values) {
  OT::Sample sample(static_cast<OT::UnsignedInteger>(values.rows()), static_cast<OT::UnsignedInteger>(values.cols()));
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (Eigen::Index column = 0; column < values.cols(); ++column) {
      sample(static_cast<OT::UnsignedInteger>(row), static_cast<OT::UnsignedInteger>(column)) = values(row, column);
    }
  }
  return sample;
}

OT::HyperbolicAnisotropicEnumerateFunction enumerate(int inputs) {
  return {static_cast<OT::UnsignedInteger>(inputs), kHyperbolicNorm};
}

}  // namespace

Eigen::MatrixXd draw_points(int n, int dimensions) {
  const std::lock_guard lock(turns());
  hush();
  const OT::Sample points =
      OT::SobolSequence(static_cast<OT::UnsignedInteger>(dimensions)).generate(static_cast<OT::UnsignedInteger>(n));
  Eigen::MatrixXd values(n, dimensions);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < dimensions; ++column) {
      values(row, column) = points(static_cast<OT::UnsignedInteger>(row), static_cast<OT::UnsignedInteger>(column));
    }
  }
  return values;
}

int count_terms(int inputs, int stratum) {
  const std::lock_guard lock(turns());
  return static_cast<int>(enumerate(inputs).getStrataCumulatedCardinal(static_cast<OT::UnsignedInteger>(stratum)));
}

std::vector<Term> select_terms(const Eigen::MatrixXd& standard, const std::vector<bool>& is_gaussian,
                               const Eigen::VectorXd& figure, int stratum) {
  const std::lock_guard lock(turns());
  hush();
  OT::ComposedDistribution::DistributionCollection measures;
  OT::OrthogonalProductPolynomialFactory::PolynomialFamilyCollection families;
  for (const bool gaussian : is_gaussian) {
    if (gaussian) {
      measures.add(OT::Normal(0.0, 1.0));
      families.add(OT::HermiteFactory());
    } else {
      measures.add(OT::Uniform(-1.0, 1.0));
      families.add(OT::LegendreFactory());
    }
  }
  const auto order = enumerate(static_cast<int>(is_gaussian.size()));
  const OT::OrthogonalProductPolynomialFactory products(families, order);
  const OT::FixedStrategy all(products, order.getStrataCumulatedCardinal(static_cast<OT::UnsignedInteger>(stratum)));
  const OT::Sample members = to_sample(standard), values = to_sample(figure);
  const OT::LeastSquaresStrategy selection(
      members, values, OT::LeastSquaresMetaModelSelectionFactory(OT::LARS(), OT::CorrectedLeaveOneOut()));
  OT::FunctionalChaosAlgorithm algorithm(members, values, OT::ComposedDistribution(measures), all, selection);
  algorithm.run();
  std::vector<Term> terms;
  for (const OT::UnsignedInteger index : algorithm.getResult().getIndices()) {
    const OT::Indices degrees = order(index);
    terms.emplace_back(degrees.begin(), degrees.end());
  }
  return terms;
}

}  // namespace lipofill::forecast
