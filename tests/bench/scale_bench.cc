#include "tests/bench/scale_bench.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::bench {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Libraries' factors in double precision of the whole coupled system.
constexpr const char* kFloorRoutes[] = {"augmented_cholesky", "mumps", "mumps_interleaved", "mumps_schur"};

double median_of(const MeasuredRoute& route, const char* phase) {
  const Samples* samples = route.phases.find(phase);
  return samples == nullptr ? 0.0 : samples->median_cpu_ms();
}

}  // namespace

absl::StatusOr<std::unique_ptr<ScaleBench>> ScaleBench::create(int scale, bool with_routes) {
  Stopwatch watch;
  auto jaw = make_jaw_angle(scale);
  if (!jaw.ok()) return jaw.status();
  std::unique_ptr<ScaleBench> bench(new ScaleBench(*std::move(jaw)));
  bench->model_build_ = watch.lap();
  if (const absl::Status status = bench->set_up(with_routes); !status.ok()) return status;
  return bench;
}

absl::Status ScaleBench::set_up(bool with_routes) {
  forget_peak();
  const double before = resident_mb();
  auto steps = WholeSteps::create(jaw_);
  if (!steps.ok()) return steps.status();
  steps_ = *std::move(steps);
  peak_mb_ = peak_resident_mb() - before;
  if (!with_routes) return absl::OkStatus();
  auto parts = StepParts::create(jaw_);
  if (!parts.ok()) return parts.status();
  parts_ = *std::move(parts);
  parts_->move_to(steps_->simulation());
  linear_ = parts_->linear_step();
  auto reference = compute_reference(linear_);
  if (!reference.ok()) return reference.status();
  reference_ = *std::move(reference);
  for (RouteKind& kind : all_routes()) {
    MeasuredRoute& measured = routes_.emplace_back();
    measured.kind = std::move(kind);
    if (!measured.kind.make || jaw_.scale > measured.kind.largest_scale) continue;
    Stopwatch watch;
    auto route = measured.kind.make(linear_);
    if (!route.ok()) return route.status();
    measured.analysis = watch.lap();
    measured.route = *std::move(route);
  }
  return absl::OkStatus();
}

absl::Status ScaleBench::run_round(int n_steps, int repeats) {
  if (const absl::Status status = steps_->advance(n_steps); !status.ok()) return status;
  for (int k = 0; k < repeats; ++k) {
    if (parts_ == nullptr) break;
    Stopwatch watch;
    parts_->assemble();
    element_work_.add(watch.lap());
    for (MeasuredRoute& route : routes_) {
      if (route.route == nullptr) continue;
      if (const absl::Status status = run_route(route); !status.ok()) return status;
    }
  }
  return absl::OkStatus();
}

absl::Status ScaleBench::run_route(MeasuredRoute& measured) {
  auto run = measured.route->run(linear_);
  if (!run.ok()) return absl::InternalError(absl::StrCat(measured.kind.name, ": ", run.status().message()));
  Span total;
  for (const auto& [phase, span] : run->phases) {
    measured.phases.add(phase, span);
    total = total + span;
  }
  measured.total.add(total);
  measured.iterations = run->iterations;
  measured.is_complete = run->is_complete;
  if (run->is_complete) {
    measured.relative_difference = std::max(measured.relative_difference, relative_difference(run->answer, reference_));
  }
  return absl::OkStatus();
}

const MeasuredRoute* ScaleBench::find_route(const std::string& name) const {
  for (const MeasuredRoute& route : routes_) {
    if (route.kind.name == name && !route.total.empty()) return &route;
  }
  return nullptr;
}

double ScaleBench::floor_ms() const {
  double least = std::numeric_limits<double>::infinity();
  for (const char* name : kFloorRoutes) {
    const MeasuredRoute* route = find_route(name);
    if (route != nullptr) least = std::min(least, median_of(*route, "factor") + median_of(*route, "solve"));
  }
  return routes_.empty() ? kNotMeasured : least + element_work_.median_cpu_ms();
}

double ScaleBench::paper_way_ms() const {
  const MeasuredRoute* route = find_route("paper_way");
  return route == nullptr ? kNotMeasured : route->total.median_cpu_ms() + element_work_.median_cpu_ms();
}

std::string ScaleBench::disagreement() const {
  for (const MeasuredRoute& route : routes_) {
    if (route.total.empty() || route.relative_difference <= kAnswerTolerance) continue;
    return absl::StrCat(route.kind.name, " at ", jaw_.scale, "x differs from the reference by ",
                        route.relative_difference, ", must be at most ", kAnswerTolerance);
  }
  return "";
}

nlohmann::ordered_json MeasuredRoute::to_json() const {
  nlohmann::ordered_json json = {{"name", kind.name}, {"what", kind.what}, {"total", nullptr}};
  if (total.empty()) return json;
  json["analysis_ms"] = 1e3 * analysis.cpu_s;
  json["total"] = total.to_json();
  json["phases"] = phases.to_json();
  json["iterations"] = iterations;
  json["is_complete"] = is_complete;
  json["relative_difference"] =
      is_complete ? nlohmann::ordered_json(relative_difference) : nlohmann::ordered_json(nullptr);
  return json;
}

nlohmann::ordered_json ScaleBench::to_json() const {
  nlohmann::ordered_json routes = nlohmann::ordered_json::array();
  for (const MeasuredRoute& route : routes_) routes.push_back(route.to_json());
  const nlohmann::ordered_json share = jaw_.scale;
  return {{"scale", jaw_.scale == kTinyScale ? nlohmann::ordered_json(kTinyShare) : share},
          {"hexahedra", steps_->simulation().n_hexahedra()},
          {"unknowns", steps_->simulation().n_dofs()},
          {"film_cells", steps_->simulation().n_film_cells()},
          {"model_build_wall_s", model_build_.wall_s},
          {"steps", steps_->to_json()},
          {"peak_rss_mb", peak_mb_},
          {"element_work", element_work_.to_json()},
          {"floor_ms", floor_ms()},
          {"paper_way_step_ms", paper_way_ms()},
          {"answer_tolerance", kAnswerTolerance},
          {"routes", routes}};
}

}  // namespace lipofill::bench
