#include "core/planning/robust.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/units.h"

namespace lipofill::planning {
namespace {

using Eigen::VectorXd;

/// Fits of the bound at most; two do for most.
constexpr int kMaxFits = 6;
/// Each fit aims at this share of the band.
constexpr double kAim = 0.99;

/// The inverse of the normal distribution, by Newton's iteration on erfc.
double normal_quantile(double share) {
  double x = 0.0;
  for (int k = 0; k < 50; ++k) {
    const double off = 0.5 * std::erfc(-x / std::numbers::sqrt2) - share;
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    x -= std::clamp(off / density, -0.5, 0.5);
  }
  return x;
}

int count_below(const VectorXd& values, double band) {
  return static_cast<int>((values.array() < band).count());
}

}  // namespace

std::vector<VectorXd> draw_moduli(int n_layers, int members, double spread) {
  std::vector<VectorXd> moduli(static_cast<size_t>(members), VectorXd(n_layers));
  std::mt19937 random(20'180'817);
  for (int layer = 0; layer < n_layers; ++layer) {
    std::vector<int> order(static_cast<size_t>(members));
    for (int k = 0; k < members; ++k) order[static_cast<size_t>(k)] = k;
    // std::shuffle differs from library to library.
    for (int k = members - 1; k > 0; --k) {
      std::swap(order[static_cast<size_t>(k)], order[random() % static_cast<unsigned>(k + 1)]);
    }
    for (int k = 0; k < members; ++k) {
      const double share = (order[static_cast<size_t>(k)] + 0.5) / members;
      moduli[static_cast<size_t>(k)][layer] = std::exp(spread * normal_quantile(share));
    }
  }
  return moduli;
}

double quantile_of(const VectorXd& values, double share) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(sorted.size()) - 1e-9));
  return sorted[std::max<size_t>(rank, 1) - 1];
}

absl::StatusOr<Robustness> make_robust(VolumeFit& fit, int n_layers, const TissueSpread& spread, ProposalBounds& bounds,
                                       FittedVolumes& fitted, const Unwanted& unwanted, ProposalCost& cost) {
  const std::vector<VectorXd> moduli = draw_moduli(n_layers, spread.members, spread.modulus_spread);
  auto pressures = fit.find_member_pressures(moduli, unwanted);
  if (!pressures.ok()) return pressures.status();
  Robustness found;
  found.members = spread.members;
  found.nominal = fitted;
  found.nominal_members_below = count_below(*pressures, spread.pressure_band);
  found.nominal_quantile = quantile_of(*pressures, spread.share);
  double quantile = found.nominal_quantile;
  for (int k = 0; k < kMaxFits && quantile >= spread.pressure_band; ++k) {
    // In proportion; members that do not hold have no pressure, and the bound is halved for them.
    const double part = std::isfinite(quantile) ? kAim * spread.pressure_band / quantile : 0.5;
    bounds.max_pressure = std::min(bounds.max_pressure, part * fitted.max_pressure());
    auto next = fit.find(bounds, unwanted);
    if (!next.ok()) return next.status();
    cost.add(next->cost);
    fitted = *std::move(next);
    pressures = fit.find_member_pressures(moduli, unwanted);
    if (!pressures.ok()) return pressures.status();
    quantile = quantile_of(*pressures, spread.share);
  }
  found.members_below = count_below(*pressures, spread.pressure_band);
  found.quantile = quantile;
  if (quantile < spread.pressure_band) return found;
  return absl::FailedPreconditionError(absl::StrFormat(
      "no volumes keep the pressure below %.2f kPa in %.0f of 100 cases: with %.2f mL it is %.2f kPa in that many",
      spread.pressure_band / kPascalsPerKilopascal, 100.0 * spread.share, fitted.total() / kCubicMetresPerMillilitre,
      quantile / kPascalsPerKilopascal));
}

}  // namespace lipofill::planning
