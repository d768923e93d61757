#include "client/cli/propose_words.h"

#include <map>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"

namespace lipofill::client {
namespace {

/// Says what holds a volume, as people say it.
std::string bound_words(const std::string& bound) {
  static const std::map<std::string, std::string> kWords = {
      {"min_zone_ml", "the least volume of a zone"},       {"max_zone_ml", "the largest volume of a zone"},
      {"max_total_ml", "the largest total volume"},        {"max_pressure_pa", "the largest pressure"},
      {"max_lift_mm", "the largest movement of the skin"}, {"tissue", "the tissue, which takes no more fat here"}};
  const auto known = kWords.find(bound);
  return known == kWords.end() ? bound : known->second;
}

void append_volume(const v1::ProposedVolume& volume, std::string& text) {
  absl::StrAppendFormat(&text, "  %-24s below %-14s %8.3f mL +- %.3f  %7.0f Pa%s%s\n", volume.zone(),
                        volume.below_layer(), volume.volume_ml(), volume.standard_error_ml(), volume.pressure_pa(),
                        volume.bound().empty() ? "" : absl::StrCat("  held by ", bound_words(volume.bound())),
                        volume.proposed_zone() ? "  (proposed)" : "");
}

}  // namespace

std::string proposal_option_of(const std::string& field) {
  static const std::map<std::string, std::string> kOthers = {{"spec.zones.below_layers", "--below"},
                                                             {"spec.spread.pressure_band_pa", "--band-pa"},
                                                             {"spec.target_scan", "--target"}};
  if (const auto known = kOthers.find(field); known != kOthers.end()) return known->second;
  if (absl::StartsWith(field, "spec.plan.")) return absl::StrCat("simulation.", absl::StripPrefix(field, "spec.plan."));
  for (const char* prefix : {"spec.bounds.", "spec.zones.", "spec."}) {
    if (!absl::StartsWith(field, prefix)) continue;
    return absl::StrCat("--", absl::StrReplaceAll(absl::StripPrefix(field, prefix), {{"_", "-"}}));
  }
  return field;
}

std::string describe(const v1::Proposal& proposal) {
  std::string text = absl::StrFormat("%.3f mL in %d zone%s\n", proposal.total_ml(), proposal.volumes_size(),
                                     proposal.volumes_size() == 1 ? "" : "s");
  for (const v1::ProposedVolume& volume : proposal.volumes()) append_volume(volume, text);
  const v1::DistanceStatistics& before = proposal.before().skin_to_target();
  const v1::DistanceStatistics& reached = proposal.reached().skin_to_target();
  absl::StrAppendFormat(&text, "skin that lacks something, to the target: rms %.2f -> %.2f mm, p95 %.2f -> %.2f mm\n",
                        before.rms_mm(), reached.rms_mm(), before.p95_mm(), reached.p95_mm());
  absl::StrAppendFormat(&text, "missing %.2f -> %.2f mL; the skin moves by up to %.2f mm\n",
                        proposal.before().volume().deficit_ml(), proposal.reached().volume().deficit_ml(),
                        proposal.max_lift_mm());
  for (const v1::Remainder& remainder : proposal.remainders()) {
    absl::StrAppend(&text, "left: ", remainder.description(), "\n");
  }
  if (proposal.has_robustness()) {
    const v1::Robustness& held = proposal.robustness();
    absl::StrAppendFormat(&text,
                          "holds in %d of %d cases of tissue, up to %.0f Pa; without that %d cases, %.3f mL, rms %.2f "
                          "mm\n",
                          held.members_below(), held.members(), held.pressure_quantile_pa(),
                          held.nominal_members_below(), held.nominal_total_ml(), held.nominal_rms_mm());
  }
  for (const v1::TradeOff& point : proposal.curve()) {
    absl::StrAppendFormat(&text, "curve: %8.3f mL  %7.0f Pa  rms %.2f mm\n", point.total_ml(), point.max_pressure_pa(),
                          point.rms_mm());
  }
  for (const std::string& remark : proposal.remarks()) absl::StrAppend(&text, "remark: ", remark, "\n");
  absl::StrAppendFormat(&text, "%d solves, %d factorisations, %.1f s\n", proposal.solves(), proposal.factorisations(),
                        proposal.wall_s());
  return text;
}

}  // namespace lipofill::client
