// In place of mumps_routes.cc where MUMPS is missing: the table says so.

#include "tests/bench/route.h"

namespace lipofill::bench {

std::vector<RouteKind> mumps_routes() {
  const std::string why = "not measured: libmumps-seq-dev was missing when this was built";
  return {{"mumps", why, nullptr},
          {"mumps_interleaved", why, nullptr},
          {"mumps_schur", why, nullptr},
          {"mumps_single", why, nullptr}};
}

}  // namespace lipofill::bench
