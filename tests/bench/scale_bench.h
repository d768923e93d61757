#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "tests/bench/linear_step.h"
#include "tests/bench/memory.h"
#include "tests/bench/route.h"
#include "tests/bench/whole_steps.h"

namespace lipofill::bench {

/// A route as it is measured at one scale.
struct MeasuredRoute {
  RouteKind kind;
  std::unique_ptr<Route> route;  ///< null: its library is missing, or the scale is beyond it
  Span analysis;
  PhaseSamples phases;
  Samples total;
  int iterations = 0;
  bool is_complete = true;
  double relative_difference = 0.0;  ///< its answer differs from the reference so much in the worst run

  nlohmann::ordered_json to_json() const;
};

/// Answers of routes may differ by this from the reference.
inline constexpr double kAnswerTolerance = 1e-7;

/// Everything that is measured on jaw_angle at one scale: whole steps, and the ways to solve a
/// linear step of theirs.
class ScaleBench {
 public:
  static absl::StatusOr<std::unique_ptr<ScaleBench>> create(int scale, bool with_routes);

  /// Does everything in turn, `repeats` times each route.
  absl::Status run_round(int n_steps, int repeats);

  int scale() const { return jaw_.scale; }
  const JawAngle& jaw() const { return jaw_; }
  const WholeSteps& steps() const { return *steps_; }
  const std::vector<MeasuredRoute>& routes() const { return routes_; }
  const MeasuredRoute* find_route(const std::string& name) const;

  /// Factor and one solve by the library that is fastest at it, and the element work [ms]; NaN
  /// without routes.
  double floor_ms() const;
  /// Element work, factor, C a column at a time, dense solve, displacement [ms]; NaN without
  /// routes.
  double paper_way_ms() const;
  /// The first route whose answer differs by more than kAnswerTolerance, as a sentence; empty:
  /// none.
  std::string disagreement() const;

  nlohmann::ordered_json to_json() const;

 private:
  explicit ScaleBench(JawAngle jaw) : jaw_(std::move(jaw)) {}
  absl::Status set_up(bool with_routes);
  absl::Status run_route(MeasuredRoute& measured);

  JawAngle jaw_;
  Span model_build_;
  std::unique_ptr<WholeSteps> steps_;
  std::unique_ptr<StepParts> parts_;
  LinearStep linear_;
  LinearAnswer reference_;
  Samples element_work_;
  std::vector<MeasuredRoute> routes_;
  double peak_mb_ = 0.0;  ///< whole steps alone came to it
};

}  // namespace lipofill::bench
