#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/simulation/plan_ensemble.h"

namespace lipofill::forecast {

/// Members that were found, as bytes with a hash at their head, and back: the same members to the
/// last bit. Nothing for bytes that are not whole, or of another number of members: such a part is
/// found again.
/// Checked by tests/unit/forecast/member_run_test.cc.
std::string write_part(const std::vector<simulation::MemberResult>& members);
std::optional<std::vector<simulation::MemberResult>> read_part(std::string_view bytes, size_t members);

}  // namespace lipofill::forecast
