#include "tests/bench/step_costs.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lipofill::bench {
namespace {

using mechanics::StepCost;
using mechanics::StepTimes;

constexpr std::array<std::pair<const char*, double StepTimes::*>, 5> kPhases = {{{"element", &StepTimes::element},
                                                                                 {"factor", &StepTimes::factor},
                                                                                 {"solve", &StepTimes::solve},
                                                                                 {"film", &StepTimes::film},
                                                                                 {"coupling", &StepTimes::coupling}}};

constexpr std::array<std::pair<const char*, int StepCost::*>, 6> kCounts = {
    {{"factorisations", &StepCost::factorisations},
     {"tissue_solves", &StepCost::tissue_solves},
     {"newton_iterations", &StepCost::newton_iterations},
     {"film_iterations", &StepCost::film_iterations},
     {"iterative_iterations", &StepCost::iterative_iterations},
     {"fallbacks", &StepCost::fallbacks}}};

}  // namespace

void StepCosts::add(const StepCost& cost) {
  ++steps_;
  double rest = cost.times.total;
  for (const auto& [name, phase] : kPhases) {
    times_.add(name, {0.0, cost.times.*phase});
    rest -= cost.times.*phase;
  }
  times_.add("rest", {0.0, std::max(0.0, rest)});
  for (const auto& [name, count] : kCounts) sum_.*count += cost.*count;
}

void StepCosts::add(const StepCosts& others) {
  for (const auto& [name, samples] : others.times_.phases()) {
    for (const Span& span : samples.spans()) times_.add(name, span);
  }
  steps_ += others.steps_;
  for (const auto& [name, count] : kCounts) sum_.*count += others.sum_.*count;
}

nlohmann::ordered_json StepCosts::to_json() const {
  nlohmann::ordered_json json = {{"steps", steps_}, {"times", times_.to_json()}};
  for (const auto& [name, count] : kCounts) json["per_step"][name] = static_cast<double>(sum_.*count) / steps_;
  return json;
}

}  // namespace lipofill::bench
