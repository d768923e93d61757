#include "tests/verification/forecast/direct_twins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>
#include <thread>

#include "core/coupling/algebra_threads.h"
#include "core/forecast/sampling.h"
#include "core/simulation/trial_shape.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::verification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using forecast::Distribution;
using forecast::Quantity;
using forecast::UncertainInput;

constexpr int kBootstraps = 200;

Twin solve_twin(const TwinCase& twin_case, const VectorXd& values) {
  model::FaceModelSpec spec = twin_case.model;
  plan::SimulationSpec plan = twin_case.plan;
  for (size_t k = 0; k < twin_case.inputs.size(); ++k) {
    const UncertainInput& input = twin_case.inputs[k];
    const double value = values[static_cast<Index>(k)];
    for (model::TissueLayerSpec& layer : spec.layers) {
      if (layer.name != input.name) continue;
      if (input.quantity == Quantity::kLayerModulus) layer.material.youngs_modulus *= value;
      if (input.quantity == Quantity::kLayerThickness) {
        for (double& thickness : layer.geometry.thickness.values) thickness *= value;
      }
    }
    if (input.quantity == Quantity::kZoneVolume) plan.injections[0].volume *= value;
  }
  auto trial = *simulation::TrialShape::create(*model::build_face_model(spec, nullptr), plan);
  EXPECT_TRUE(trial->find({}, false).ok());
  EXPECT_EQ(trial->share(), 1.0) << trial->reason();
  const VectorXd lifts = trial->skin_displacement().colwise().norm();
  return {lifts.maxCoeff(), trial->shape().report().skin_volume_change, trial->shape().zone_reports()[0].mean_pressure,
          lifts};
}

MatrixXd through_distributions(const std::vector<UncertainInput>& inputs, const MatrixXd& points) {
  MatrixXd values(points.rows(), points.cols());
  for (Index k = 0; k < points.cols(); ++k) {
    for (Index row = 0; row < points.rows(); ++row) {
      values(row, k) = inputs[static_cast<size_t>(k)].distribution.quantile(points(row, k));
    }
  }
  return values;
}

/// A figure of each patient of A, of B, and of A with an input of B, in columns.
struct Sample {
  VectorXd a, b;
  MatrixXd mixed;
};

struct Indices {
  VectorXd first, total;
};

/// @param who  the patients that count, as often as they are named
Indices estimate(const Sample& sample, const std::vector<Index>& who) {
  const auto n = static_cast<double>(who.size());
  double sum = 0.0, squares = 0.0;
  for (const Index k : who) {
    sum += sample.a[k] + sample.b[k];
    squares += sample.a[k] * sample.a[k] + sample.b[k] * sample.b[k];
  }
  const double mean = sum / (2.0 * n);
  const double variance = squares / (2.0 * n) - mean * mean;
  Indices indices{VectorXd::Zero(sample.mixed.cols()), VectorXd::Zero(sample.mixed.cols())};
  for (Index input = 0; input < sample.mixed.cols(); ++input) {
    double from_b = 0.0, from_a = 0.0;
    for (const Index k : who) {
      from_b += std::pow(sample.b[k] - sample.mixed(k, input), 2);
      from_a += std::pow(sample.a[k] - sample.mixed(k, input), 2);
    }
    indices.first[input] = 1.0 - from_b / (2.0 * n * variance);
    indices.total[input] = from_a / (2.0 * n * variance);
  }
  return indices;
}

}  // namespace

TwinCase make_twin_case() {
  TwinCase twin_case{simulation::make_small_model_spec(), simulation::make_small_plan(), {}};
  twin_case.inputs = {{Quantity::kLayerModulus, "skin", Distribution::log_normal(1.0, 0.4), "", false},
                      {Quantity::kLayerModulus, "muscle", Distribution::log_normal(1.0, 0.5), "", false},
                      {Quantity::kLayerThickness, "skin", Distribution::log_normal(1.0, 0.1), "", false},
                      {Quantity::kZoneVolume, "all", Distribution::normal(1.0, 0.08), "", false}};
  return twin_case;
}

std::vector<Twin> solve_twins(const TwinCase& twin_case, const MatrixXd& values, int threads) {
  std::vector<Twin> twins(static_cast<size_t>(values.rows()));
  std::atomic<Index> next = 0;
  const auto work = [&] {
    coupling::pin_algebra_to_this_thread();
    for (Index k = next++; k < values.rows(); k = next++) {
      twins[static_cast<size_t>(k)] = solve_twin(twin_case, values.row(k));
    }
  };
  std::vector<std::thread> others;
  for (int k = 1; k < threads; ++k) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
  return twins;
}

MatrixXd draw_evenly(const std::vector<UncertainInput>& inputs, int n, unsigned seed) {
  std::mt19937 random(seed);
  MatrixXd points(n, static_cast<Index>(inputs.size()));
  for (Index k = 0; k < points.cols(); ++k) {
    std::vector<int> order(static_cast<size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    // std::shuffle differs from library to library.
    for (int row = n - 1; row > 0; --row) {
      std::swap(order[static_cast<size_t>(row)], order[random() % static_cast<unsigned>(row + 1)]);
    }
    for (int row = 0; row < n; ++row) {
      const double within = (static_cast<double>(random()) + 0.5) / 4294967296.0;
      points(row, k) = (order[static_cast<size_t>(row)] + within) / n;
    }
  }
  return through_distributions(inputs, points);
}

PickedIndices find_indices_by_runs(const TwinCase& twin_case, int n, int threads) {
  const auto n_inputs = static_cast<Index>(twin_case.inputs.size());
  const MatrixXd points = forecast::draw_points(n, static_cast<int>(2 * n_inputs));
  const MatrixXd a = through_distributions(twin_case.inputs, points.leftCols(n_inputs));
  const MatrixXd b = through_distributions(twin_case.inputs, points.rightCols(n_inputs));
  PickedIndices picked;
  picked.runs = n * static_cast<int>(n_inputs + 2);
  std::vector<std::vector<Twin>> mixed;
  for (Index input = 0; input < n_inputs; ++input) {
    MatrixXd values = a;
    values.col(input) = b.col(input);
    mixed.push_back(solve_twins(twin_case, values, threads));
  }
  const std::vector<Twin> of_a = solve_twins(twin_case, a, threads), of_b = solve_twins(twin_case, b, threads);
  for (MatrixXd* to : {&picked.first, &picked.total, &picked.first_error, &picked.total_error}) {
    to->setZero(Twin::kFigures, n_inputs);
  }
  std::vector<Index> all(static_cast<size_t>(n));
  std::iota(all.begin(), all.end(), Index{0});
  std::mt19937 random(5);
  for (int figure = 0; figure < Twin::kFigures; ++figure) {
    Sample sample{VectorXd(n), VectorXd(n), MatrixXd(n, n_inputs)};
    for (Index k = 0; k < n; ++k) {
      const auto row = static_cast<size_t>(k);
      sample.a[k] = of_a[row].figure(figure);
      sample.b[k] = of_b[row].figure(figure);
      for (Index i = 0; i < n_inputs; ++i) sample.mixed(k, i) = mixed[static_cast<size_t>(i)][row].figure(figure);
    }
    const Indices found = estimate(sample, all);
    picked.first.row(figure) = found.first;
    picked.total.row(figure) = found.total;
    for (int draw = 0; draw < kBootstraps; ++draw) {
      std::vector<Index> some(all.size());
      for (Index& k : some) k = static_cast<Index>(random() % static_cast<unsigned>(n));
      const Indices again = estimate(sample, some);
      picked.first_error.row(figure) += (again.first - found.first).cwiseAbs2().transpose();
      picked.total_error.row(figure) += (again.total - found.total).cwiseAbs2().transpose();
    }
  }
  picked.first_error = (picked.first_error / kBootstraps).cwiseSqrt();
  picked.total_error = (picked.total_error / kBootstraps).cwiseSqrt();
  picked.patients = of_a;
  picked.patients.insert(picked.patients.end(), of_b.begin(), of_b.end());
  return picked;
}

}  // namespace lipofill::verification
