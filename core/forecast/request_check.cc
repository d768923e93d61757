// This file tells what is wrong with the numbers of a request for a forecast.

#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "core/forecast/forecast.h"

namespace lipofill::forecast {
namespace {

constexpr int kLeastMembers = 50;
constexpr int kMostMembers = 10'000;
constexpr size_t kMostTimes = 6;
constexpr double kMostMonths = 60.0;

}  // namespace

void check_request(const ForecastRequest& request, FieldViolations& violations) {
  violations.check_range("members", request.members, kLeastMembers, kMostMembers, "");
  if (request.months.empty() || request.months.size() > kMostTimes) {
    violations.add("months", absl::StrCat("has ", request.months.size(), " times, must have 1 to ", kMostTimes));
  }
  double before = 0.0;
  for (size_t k = 0; k < request.months.size(); ++k) {
    if (request.months[k] > before && request.months[k] <= kMostMonths) {
      before = request.months[k];
      continue;
    }
    violations.add(absl::StrCat("months[", k, "]"),
                   absl::StrCat("is ", request.months[k], ", must be in (", before, ", ", kMostMonths, "]"));
  }
  std::set<std::string> zones;
  double injected = 0.0;
  for (const plan::InjectionSpec& injection : request.plan.injections) {
    zones.insert(injection.zone);
    injected += injection.volume;
  }
  if (zones.empty()) violations.add("plan.injections", "has none: there is nothing to forecast");
  for (const auto& [zone, volume] : request.wanted) {
    const std::string field = absl::StrCat("wanted[", zone, "]");
    if (!zones.contains(zone)) violations.add(field, "the plan has no injection into a zone of that name");
    violations.check_range(field, volume / kCubicMetresPerMillilitre, 0.0, 1000.0, "mL");
  }
  if (request.follow_up && !zones.empty()) {
    const FollowUp& found = *request.follow_up;
    check_follow_up("follow_up", found.month, found.volume, found.standard_error, injected, violations);
  }
}

}  // namespace lipofill::forecast
