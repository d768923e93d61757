#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "tests/bench/linear_step.h"
#include "tests/bench/measure.h"

namespace lipofill::bench {

/// Where a route's time goes, phase by phase.
using Phases = std::vector<std::pair<std::string, Span>>;

/// What a route gives and what it took.
struct RouteRun {
  LinearAnswer answer;
  Phases phases;
  int iterations = 0;       ///< 0: a direct method
  bool is_complete = true;  ///< false: a stated sample of the work, and no answer
};

/// A way to solve a linear step. Patterns are analysed when it is made; each run takes the values
/// anew.
class Route {
 public:
  virtual ~Route() = default;
  virtual absl::StatusOr<RouteRun> run(const LinearStep& step) = 0;
};

/// A way and how to make it; `make` is empty where its library is missing.
struct RouteKind {
  std::string name;
  std::string what;
  std::function<absl::StatusOr<std::unique_ptr<Route>>(const LinearStep& step)> make;
  int largest_scale = 16;  ///< beyond, a run takes too long to be worth it
};

/// What the choice of a solver was made from; the order is that of the tables.
std::vector<RouteKind> all_routes();

/// The parts of all_routes().
std::vector<RouteKind> own_routes();
std::vector<RouteKind> cholmod_routes();
std::vector<RouteKind> eigen_routes();
std::vector<RouteKind> mumps_routes();

/// An answer good to round-off: conjugate gradients on the pressure over a factor of S, twice
/// corrected by residuals in extended precision. Independent of what is measured.
absl::StatusOr<LinearAnswer> compute_reference(const LinearStep& step);

}  // namespace lipofill::bench
