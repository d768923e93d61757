// Intervals of 90 of 100 hold fresh cases of the same kind: plans of their own on models of their
// own, drawn by random numbers that the ensemble knows nothing of.

#include <gtest/gtest.h>

#include <random>

#include "core/forecast/forecast.h"
#include "core/simulation/trial_shape.h"
#include "tests/unit/simulation/small_case.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using forecast::Distribution;
using forecast::FigureKind;
using forecast::Quantity;

constexpr int kTwins = 60;

struct Twin {
  double lift = 0.0, volume = 0.0, pressure = 0.0;
  Eigen::VectorXd lift_of_node;
};

/// A patient: stiffness, thickness and delivered volume drawn; solved from rest.
class Twins {
 public:
  explicit Twins(const std::vector<forecast::UncertainInput>& inputs) : inputs_(inputs) {}

  Twin draw() {
    model::FaceModelSpec spec = simulation::make_small_model_spec();
    plan::SimulationSpec plan = simulation::make_small_plan();
    for (const forecast::UncertainInput& input : inputs_) {
      const double value = input.distribution.quantile((static_cast<double>(random_()) + 0.5) / 4294967296.0);
      for (model::TissueLayerSpec& layer : spec.layers) {
        if (layer.name != input.name) continue;
        if (input.quantity == Quantity::kLayerModulus) layer.material.youngs_modulus *= value;
        if (input.quantity == Quantity::kLayerThickness) {
          layer.geometry.thickness = geometry::ScalarField::constant(value * (layer.name == "skin" ? 2e-3 : 8e-3));
        }
      }
      if (input.quantity == Quantity::kZoneVolume) plan.injections[0].volume *= value;
    }
    auto trial = *simulation::TrialShape::create(*model::build_face_model(spec, nullptr), plan);
    EXPECT_TRUE(trial->find({}, false).ok());
    const Eigen::VectorXd lifts = trial->skin_displacement().colwise().norm();
    return {lifts.maxCoeff(), trial->shape().report().skin_volume_change,
            trial->shape().zone_reports()[0].mean_pressure, lifts};
  }

 private:
  const std::vector<forecast::UncertainInput>& inputs_;
  std::mt19937 random_{11};
};

const forecast::Spread& spread_of(const forecast::ForecastTime& time, FigureKind kind) {
  for (const forecast::ForecastFigure& figure : time.figures) {
    if (figure.kind == kind) return figure.spread;
  }
  return time.figures.front().spread;
}

TEST(Coverage, IntervalsHoldNinetyOfAHundredFreshCases) {
  Case coverage(
      {"forecast/3-coverage", "Intervals of 90 of 100, held against fresh cases",
       "Sixty plans of their own, drawn from the same distributions and solved from rest; of sixty 90 % are 54 "
       "+- 2.3."});
  forecast::ForecastRequest request;
  request.plan = simulation::make_small_plan();
  request.members = 400;
  request.months = {12.0};
  request.only_named_inputs = true;
  request.session_band = 4000.0;
  request.inputs = {{Quantity::kLayerModulus, "skin", Distribution::log_normal(1.0, 0.4), "", false},
                    {Quantity::kLayerModulus, "muscle", Distribution::log_normal(1.0, 0.5), "", false},
                    {Quantity::kLayerThickness, "skin", Distribution::log_normal(1.0, 0.1), "", false},
                    {Quantity::kZoneVolume, "all", Distribution::normal(1.0, 0.08), "", false}};
  const auto made = forecast::make_forecast(simulation::make_small_model(), request, 2, {}, nullptr);
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_EQ(made->failed, 0);
  const forecast::ForecastTime& now = made->times.front();
  Twins twins(request.inputs);
  int lift = 0, volume = 0, pressure = 0;
  double nodes = 0.0;
  const auto holds = [&](FigureKind kind, double value) {
    const forecast::Spread& spread = spread_of(now, kind);
    return spread.p05 <= value && value <= spread.p95;
  };
  for (int k = 0; k < kTwins; ++k) {
    const Twin twin = twins.draw();
    lift += holds(FigureKind::kMaxLift, twin.lift);
    volume += holds(FigureKind::kSkinVolume, twin.volume);
    pressure += holds(FigureKind::kMeanPressure, twin.pressure);
    int inside = 0, moving = 0;
    for (Eigen::Index node = 0; node < twin.lift_of_node.size(); ++node) {
      if (now.lift_p95[node] < 1e-4) continue;  // next to the rim nothing moves
      ++moving;
      inside += now.lift_p05[node] <= twin.lift_of_node[node] && twin.lift_of_node[node] <= now.lift_p95[node];
    }
    nodes += static_cast<double>(inside) / moving / kTwins;
  }
  // Three standard deviations of a count of sixty.
  coverage.record({"largest lift: share inside", "1", 0.9, lift / 60.0, 0.117, Bound::kAbsolute});
  coverage.record({"volume of the skin: share inside", "1", 0.9, volume / 60.0, 0.117, Bound::kAbsolute});
  coverage.record({"pressure: share inside", "1", 0.9, pressure / 60.0, 0.117, Bound::kAbsolute});
  coverage.record({"lift of a vertex: share inside", "1", 0.9, nodes, 0.117, Bound::kAbsolute});
}

}  // namespace
}  // namespace lipofill::verification
