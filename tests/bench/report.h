#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tests/bench/equilibrium_bench.h"
#include "tests/bench/memory.h"
#include "tests/bench/scale_bench.h"
#include "tests/bench/whole_steps.h"

namespace lipofill::bench {

/// All that one run of the program found.
struct Findings {
  int rounds = 0;
  std::vector<std::unique_ptr<ScaleBench>> scales;            ///< ascending; the first is what the bounds are for
  std::vector<SettledRun> as_planned;                         ///< one a round
  std::vector<SettledRun> settled_shape;                      ///< each round has one run with that goal
  std::vector<SettledRun> settled_in_steps;                   ///< the same where the plan has to be stepped
  std::vector<std::unique_ptr<EquilibriumBench>> equilibria;  ///< of the scales up to 16
  std::unique_ptr<EquilibriumBench> attached;                 ///< with neo-Hookean layers and attached edges
  SessionMemory memory;
  nlohmann::ordered_json beyond =
      nlohmann::ordered_json::array();  ///< has scales too large to be held beside the others
};

/// The content of bench.json. Times are processor time of the one thread that works, but for names
/// with `wall`.
nlohmann::ordered_json make_report(const Findings& findings);

/// The report for people.
void print_report(const nlohmann::ordered_json& report, std::ostream& out);

}  // namespace lipofill::bench
