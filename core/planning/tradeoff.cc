#include "core/planning/tradeoff.h"

#include <algorithm>

namespace lipofill::planning {

TradeOff make_trade_off(const ProposalCase& face, const FittedVolumes& fitted) {
  return {fitted.volumes, fitted.pressure, fitted.bound, face.rms(fitted.distance), face.p95(fitted.distance)};
}

bool dominates(const TradeOff& one, const TradeOff& other) {
  const bool no_worse =
      one.rms <= other.rms && one.total() <= other.total() && one.max_pressure() <= other.max_pressure();
  const bool better = one.rms < other.rms || one.total() < other.total() || one.max_pressure() < other.max_pressure();
  return no_worse && better;
}

absl::StatusOr<std::vector<TradeOff>> trace_trade_off(const ProposalCase& face, VolumeFit& fit,
                                                      const FittedVolumes& fitted, const ProposalBounds& bounds,
                                                      int n_points, const Unwanted& unwanted, ProposalCost& cost) {
  std::vector<ProposalBounds> tried;
  const int n_pressures = fit.zones().size() > 1 && fitted.max_pressure() > 0.0 ? (n_points - 1) / 2 : 0;
  const int n_totals = n_points - 1 - n_pressures;
  for (int k = 1; k <= n_totals; ++k) {
    tried.push_back(bounds);
    tried.back().max_total = fitted.total() * k / (n_totals + 1);
  }
  for (int k = 1; k <= n_pressures; ++k) {
    tried.push_back(bounds);
    tried.back().max_pressure = fitted.max_pressure() * k / (n_pressures + 1);
  }
  const TradeOff best = make_trade_off(face, fitted);
  std::vector<TradeOff> all;
  double least = 0.0;
  for (const SoughtZone& zone : fit.zones()) least += zone.bounds.low;
  for (const ProposalBounds& some : tried) {
    if (some.max_total < least) continue;
    const auto found = fit.find(some, unwanted);
    if (absl::IsCancelled(found.status())) return found.status();
    if (!found.ok()) continue;  // these bounds admit nothing, others do
    cost.add(found->cost);
    all.push_back(make_trade_off(face, *found));
  }
  std::vector<TradeOff> curve = {best};
  for (const TradeOff& point : all) {
    const auto beats = [&](const TradeOff& other) { return dominates(other, point); };
    if (std::none_of(all.begin(), all.end(), beats) && !beats(best)) curve.push_back(point);
  }
  std::stable_sort(curve.begin(), curve.end(),
                   [](const TradeOff& a, const TradeOff& b) { return a.total() < b.total(); });
  return curve;
}

}  // namespace lipofill::planning
