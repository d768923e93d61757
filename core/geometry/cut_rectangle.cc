#include "core/geometry/cut_rectangle.h"

#include <algorithm>
#include <cmath>

namespace lipofill::geometry {
namespace {

constexpr double kRoundOff = 1e-9;

/// A corner of a polygon in the rectangle's own coordinates.
struct Corner {
  double s = 0.0;
  double t = 0.0;
};
using Polygon = std::vector<Corner>;

Corner between(const Corner& a, const Corner& b, double share) {
  return {a.s + share * (b.s - a.s), a.t + share * (b.t - a.t)};
}

/// Where the level is zero between two places of opposite sign: false position, whose first step is
/// exact for a level that is linear there.
double find_crossing(double low_value, double high_value, const std::function<double(double)>& value_at) {
  constexpr int kSteps = 3;
  double low = 0.0;
  double high = 1.0;
  double share = 0.5;
  for (int step = 0; step < kSteps; ++step) {
    share = low + (high - low) * low_value / (low_value - high_value);
    const double value = value_at(share);
    if (value == 0.0) break;
    const bool is_low = (value < 0.0) == (low_value < 0.0);
    (is_low ? low : high) = share;
    (is_low ? low_value : high_value) = value;
  }
  return share;
}

/// The part of a polygon where the level is at least zero.
Polygon clip(const Polygon& polygon, const std::function<double(const Corner&)>& level) {
  Polygon inside;
  std::vector<double> values;
  for (const Corner& corner : polygon) values.push_back(level(corner));
  for (size_t k = 0; k < polygon.size(); ++k) {
    const size_t next = (k + 1) % polygon.size();
    if (values[k] >= 0.0) inside.push_back(polygon[k]);
    if ((values[k] >= 0.0) == (values[next] >= 0.0)) continue;
    const auto at = [&](double share) { return level(between(polygon[k], polygon[next], share)); };
    inside.push_back(between(polygon[k], polygon[next], find_crossing(values[k], values[next], at)));
  }
  return inside;
}

/// Adds a triangle's integrals, exact for polynomials of second degree.
void add_triangle(const Corner& a, const Corner& b, const Corner& c, RectangleMoments& moments) {
  const double area = 0.5 * ((b.s - a.s) * (c.t - a.t) - (c.s - a.s) * (b.t - a.t));
  for (const Corner& middle : {between(a, b, 0.5), between(b, c, 0.5), between(c, a, 0.5)}) {
    moments.one += area / 3.0;
    moments.s += area / 3.0 * middle.s;
    moments.t += area / 3.0 * middle.t;
    moments.st += area / 3.0 * middle.s * middle.t;
  }
}

/// Smallest and largest value of a level over the corners, the middles of the sides and the centre.
std::pair<double, double> range_of(const std::function<double(const Corner&)>& level) {
  double low = level({0.0, 0.0});
  double high = low;
  for (const double t : {0.0, 0.5, 1.0}) {
    for (const double s : {0.0, 0.5, 1.0}) {
      const double value = level({s, t});
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  return {low, high};
}

constexpr RectangleMoments kWhole{1.0, 0.5, 0.5, 0.25};

}  // namespace

RectangleMoments integrate_inside(const ChartBox& box, const std::vector<Level>& levels) {
  std::vector<std::function<double(const Corner&)>> cutting;
  for (const Level& level : levels) {
    const auto local = [&box, &level](const Corner& at) {
      return level({box.xi_min + at.s * (box.xi_max - box.xi_min), box.eta_min + at.t * (box.eta_max - box.eta_min)});
    };
    const auto [low, high] = range_of(local);
    if (high < 0.0) return {};
    if (low < 0.0) cutting.emplace_back(local);
  }
  if (cutting.empty()) return kWhole;
  RectangleMoments moments;
  for (const double t : {0.0, 0.5}) {
    for (const double s : {0.0, 0.5}) {
      Polygon polygon = {{s, t}, {s + 0.5, t}, {s + 0.5, t + 0.5}, {s, t + 0.5}};
      for (const auto& level : cutting) polygon = clip(polygon, level);
      for (size_t k = 1; k + 1 < polygon.size(); ++k) add_triangle(polygon[0], polygon[k], polygon[k + 1], moments);
    }
  }
  if (moments.one < kRoundOff) return {};
  return moments.one > 1.0 - kRoundOff ? kWhole : moments;
}

std::array<double, 4> fit_gauss_shares(const RectangleMoments& moments) {
  if (moments.one == 1.0) return {1.0, 1.0, 1.0, 1.0};
  const double low = 0.5 - 0.5 / std::sqrt(3.0);
  const double high = 1.0 - low;
  /// The integral of (a - s) (b - t), which is zero at two of the points' columns and rows.
  const auto product = [&](double a, double b) {
    return a * b * moments.one - b * moments.s - a * moments.t + moments.st;
  };
  const double scale = 4.0 / ((high - low) * (high - low));
  return {scale * product(high, high), -scale * product(low, high), -scale * product(high, low),
          scale * product(low, low)};
}

std::vector<OutlineSegment> trace_outline(const Level& level, int n_xi, int n_eta) {
  const auto point = [&](int i, int j) {
    return ChartPoint{static_cast<double>(i) / n_xi, static_cast<double>(j) / n_eta};
  };
  std::vector<double> values;
  for (int j = 0; j <= n_eta; ++j) {
    for (int i = 0; i <= n_xi; ++i) values.push_back(level(point(i, j)));
  }
  std::vector<OutlineSegment> segments;
  for (int j = 0; j < n_eta; ++j) {
    for (int i = 0; i < n_xi; ++i) {
      const std::array<std::array<int, 2>, 4> corners = {{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
      std::vector<ChartPoint> crossings;
      for (int k = 0; k < 4; ++k) {
        const auto [i0, j0] = corners[k];
        const auto [i1, j1] = corners[(k + 1) % 4];
        const double from = values[j0 * (n_xi + 1) + i0];
        const double to = values[j1 * (n_xi + 1) + i1];
        if ((from >= 0.0) == (to >= 0.0)) continue;
        const ChartPoint a = point(i0, j0);
        const ChartPoint b = point(i1, j1);
        const auto on_side = [&](double share) {
          return ChartPoint{a.xi + share * (b.xi - a.xi), a.eta + share * (b.eta - a.eta)};
        };
        crossings.push_back(on_side(find_crossing(from, to, [&](double share) { return level(on_side(share)); })));
      }
      if (crossings.size() == 2) segments.push_back({crossings[0], crossings[1]});
      if (crossings.size() != 4) continue;
      // Two corners that lie across from one another are inside: the centre says whether they are
      // joined.
      const ChartPoint a = point(i, j);
      const ChartPoint c = point(i + 1, j + 1);
      const bool joined = level({0.5 * (a.xi + c.xi), 0.5 * (a.eta + c.eta)}) >= 0.0;
      const bool first_inside = values[j * (n_xi + 1) + i] >= 0.0;
      if (joined == first_inside) {
        segments.push_back({crossings[0], crossings[1]});
        segments.push_back({crossings[2], crossings[3]});
      } else {
        segments.push_back({crossings[3], crossings[0]});
        segments.push_back({crossings[1], crossings[2]});
      }
    }
  }
  return segments;
}

}  // namespace lipofill::geometry
