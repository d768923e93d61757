#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/service/sessions_bench.h"
#include "tests/bench/service/startup_bench.h"
#include "tests/bench/service/viewers_bench.h"

namespace lipofill::bench {

using Json = nlohmann::ordered_json;

/// Each prints a table to the error output and returns it as JSON.
Json show(const std::vector<SessionsRow>& rows);
/// The first row is what the others are compared with.
Json show(const std::vector<ViewersRow>& rows);
Json show(const std::string& what, const StartupTable& table);

}  // namespace lipofill::bench
