#include "core/geometry/level.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace lipofill::geometry {
namespace {

/// Marching squares on a lattice of the chart.
class Tracer {
 public:
  Tracer(const Level& level, int n_xi, int n_eta) : level_(level), n_xi_(n_xi), n_eta_(n_eta) {
    for (int j = 0; j <= n_eta; ++j) {
      for (int i = 0; i <= n_xi; ++i) values_.push_back(value_at(point(i, j)));
    }
    for (int j = 0; j < n_eta; ++j) {
      for (int i = 0; i < n_xi; ++i) add_rectangle(i, j);
    }
  }

  /// Each crossing ends one chord and begins the next.
  std::vector<OutlineLoop> take_loops() {
    std::vector<OutlineLoop> loops;
    while (!next_.empty()) {
      OutlineLoop& loop = loops.emplace_back();
      for (auto chord = next_.begin(); chord != next_.end();) {
        loop.push_back(place_.at(chord->first));
        const int to = chord->second;
        next_.erase(chord);
        chord = next_.find(to);
      }
    }
    return loops;
  }

 private:
  /// A side of the lattice that the outline crosses.
  struct Crossing {
    int side = 0;
    bool leaves = false;  ///< going around the rectangle anticlockwise, it leads from inside to outside
  };

  ChartPoint point(int i, int j) const { return {static_cast<double>(i) / n_xi_, static_cast<double>(j) / n_eta_}; }

  /// The level, negative on the border of the chart.
  double value_at(const ChartPoint& p) const {
    constexpr double kRim = 1e-12;
    return std::min({level_(p), p.xi - kRim, 1.0 - kRim - p.xi, p.eta - kRim, 1.0 - kRim - p.eta});
  }

  void add_rectangle(int i, int j) {
    const std::array<std::array<int, 2>, 4> corners = {{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
    std::vector<Crossing> crossings;
    for (int k = 0; k < 4; ++k) {
      const double from = value(corners[k]);
      const double to = value(corners[(k + 1) % 4]);
      if ((from >= 0.0) == (to >= 0.0)) continue;
      crossings.push_back({cross(corners[k], corners[(k + 1) % 4]), from >= 0.0});
    }
    if (crossings.size() == 2) join(crossings[0], crossings[1]);
    if (crossings.size() != 4) return;
    // Two corners that lie across from one another are inside: the centre says whether they are
    // joined.
    const ChartPoint middle{(i + 0.5) / n_xi_, (j + 0.5) / n_eta_};
    const bool are_joined = value_at(middle) >= 0.0;
    const size_t shift = are_joined == crossings[0].leaves ? 0 : 1;
    join(crossings[shift], crossings[shift + 1]);
    join(crossings[shift + 2], crossings[(shift + 3) % 4]);
  }

  double value(const std::array<int, 2>& at) const { return values_[at[1] * (n_xi_ + 1) + at[0]]; }

  /// Numbers a side of the lattice and finds where the outline crosses it, from its lower end.
  int cross(std::array<int, 2> a, std::array<int, 2> b) {
    if (b < a) std::swap(a, b);
    const int side = 2 * (a[1] * (n_xi_ + 1) + a[0]) + (a[0] == b[0] ? 1 : 0);
    if (place_.contains(side)) return side;
    const ChartPoint low = point(a[0], a[1]);
    const ChartPoint high = point(b[0], b[1]);
    const auto on_side = [&](double share) {
      return ChartPoint{low.xi + share * (high.xi - low.xi), low.eta + share * (high.eta - low.eta)};
    };
    place_[side] = on_side(find_zero(value(a), value(b), [&](double share) { return value_at(on_side(share)); }));
    return side;
  }

  void join(const Crossing& a, const Crossing& b) {
    if (a.leaves) {
      next_[a.side] = b.side;
    } else {
      next_[b.side] = a.side;
    }
  }

  const Level& level_;
  int n_xi_;
  int n_eta_;
  std::vector<double> values_;
  std::map<int, ChartPoint> place_;  ///< of the crossing on a side
  std::map<int, int> next_;          ///< side on which the chord ends that begins on a side
};

}  // namespace

double find_zero(double value_at_0, double value_at_1, const std::function<double(double)>& value_at) {
  constexpr int kSteps = 3;
  double low = 0.0;
  double high = 1.0;
  double zero = 0.5;
  for (int step = 0; step < kSteps; ++step) {
    zero = low + (high - low) * value_at_0 / (value_at_0 - value_at_1);
    const double value = value_at(zero);
    if (value == 0.0) break;
    const bool is_low = (value < 0.0) == (value_at_0 < 0.0);
    (is_low ? low : high) = zero;
    (is_low ? value_at_0 : value_at_1) = value;
  }
  return zero;
}

std::vector<OutlineLoop> trace_outline(const Level& level, int n_xi, int n_eta) {
  return Tracer(level, n_xi, n_eta).take_loops();
}

}  // namespace lipofill::geometry
