#include "tests/bench/route.h"

namespace lipofill::bench {

std::vector<RouteKind> all_routes() {
  std::vector<RouteKind> all = own_routes();
  for (auto* more : {&cholmod_routes, &mumps_routes, &eigen_routes}) {
    for (RouteKind& kind : more()) all.push_back(std::move(kind));
  }
  return all;
}

}  // namespace lipofill::bench
