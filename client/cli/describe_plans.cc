#include "client/cli/describe_plans.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "google/protobuf/util/time_util.h"

namespace lipofill::client {
namespace {

using google::protobuf::util::TimeUtil;

std::string side_name(v1::PlanSide side) {
  switch (side) {
    case v1::LEFT_SIDE:
      return "left";
    case v1::RIGHT_SIDE:
      return "right";
    case v1::BOTH_SIDES:
      return "both";
    default:
      return "-";
  }
}

double volume_ml(const v1::Plan& plan) {
  double total = 0.0;
  for (const v1::Injection& injection : plan.simulation().injections()) total += injection.volume_ml();
  for (const v1::PlanPart& part : plan.parts()) {
    for (const v1::Injection& injection : part.simulation().injections()) total += injection.volume_ml();
  }
  return total;
}

}  // namespace

std::string describe(const v1::SavedPlan& plan) {
  std::string text = absl::StrFormat("%s\n  title     %s\n  side      %s\n  scan      %s\n", plan.name(),
                                     plan.title().empty() ? "-" : plan.title(), side_name(plan.side()),
                                     plan.scan().empty() ? "-" : plan.scan());
  if (!plan.target_scan().empty()) absl::StrAppend(&text, "  target    ", plan.target_scan(), "\n");
  absl::StrAppendFormat(&text, "  plan      %d films, %d injections, %.2f mL\n",
                        plan.content().simulation().films_size(), plan.content().simulation().injections_size(),
                        volume_ml(plan.content()));
  absl::StrAppendFormat(&text, "  changed   %s, revision %d, etag %s\n", TimeUtil::ToString(plan.update_time()),
                        plan.revision(), plan.etag());
  for (const v1::PlanRun& run : plan.runs()) {
    const bool is_present = run.content_hash() == plan.content_hash();
    absl::StrAppend(&text, "  run       ", run.simulation(), is_present ? "" : ": the plan has changed since", "\n");
  }
  return text;
}

std::string describe(const v1::PlanRevision& revision) {
  std::string text = absl::StrFormat("%6d  %s  %s\n", revision.revision(), TimeUtil::ToString(revision.create_time()),
                                     revision.title());
  for (const std::string& change : revision.changes()) absl::StrAppend(&text, "        ", change, "\n");
  return text;
}

std::string list_line(const v1::SavedPlan& plan) {
  return absl::StrFormat("%-50s %-5s %8.2f mL  %s  %s\n", plan.name(), side_name(plan.side()),
                         volume_ml(plan.content()), TimeUtil::ToString(plan.update_time()), plan.title());
}

}  // namespace lipofill::client
