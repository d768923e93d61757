#include "core/geometry/cut_rectangle.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

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
    inside.push_back(between(polygon[k], polygon[next], find_zero(values[k], values[next], at)));
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

}  // namespace lipofill::geometry
