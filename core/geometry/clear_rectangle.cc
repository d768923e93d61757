#include "core/geometry/clear_rectangle.h"

#include <algorithm>
#include <limits>

namespace lipofill::geometry {
namespace {

/// A side that has moved to its distance from an obstacle is not too close to it.
constexpr double kRoundOff = 1e-9;

/// A side that moves in: 0 low x, 1 high x, 2 low y, 3 high y.
struct Move {
  int side = -1;
  double to = 0.0;      ///< where the side comes to lie
  double margin = 0.0;  ///< that is left between it and the box; negative within the box
  int lost = 0;         ///< points of the content
};

double& side_of(Rectangle& rectangle, int side) {
  return side % 2 == 0 ? rectangle.low[side / 2] : rectangle.high[side / 2];
}

bool is_too_close(const Rectangle& rectangle, const ObstaclePoint& obstacle) {
  const Eigen::Array2d p = obstacle.position.array();
  const double clearance = obstacle.clearance - kRoundOff;
  return (p > rectangle.low.array() - clearance).all() && (p < rectangle.high.array() + clearance).all();
}

int count_lost(const Rectangle& before, const Rectangle& after, const std::vector<Eigen::Vector2d>& content) {
  return static_cast<int>(std::count_if(content.begin(), content.end(), [&](const Eigen::Vector2d& p) {
    return before.contains(p) && !after.contains(p);
  }));
}

/// The move that clears an obstacle at least cost.
Move find_best_move(const Rectangle& box, const Rectangle& now, const ObstaclePoint& obstacle,
                    const std::vector<Eigen::Vector2d>& content) {
  Move best;
  for (int side = 0; side < 4; ++side) {
    const double sign = side % 2 == 0 ? 1.0 : -1.0;
    Rectangle from = box;
    Move move{side, obstacle.position[side / 2] + sign * obstacle.clearance, 0.0, 0};
    move.margin = sign * (side_of(from, side) - move.to);
    if (move.margin < 0.0) {
      Rectangle after = now;
      side_of(after, side) = move.to;
      move.lost = count_lost(now, after, content);
    }
    const bool better = move.lost != best.lost ? move.lost < best.lost : move.margin > best.margin;
    if (best.side < 0 || better) best = move;
  }
  return best;
}

}  // namespace

ClearRectangle find_clear_rectangle(const Rectangle& box, double margin, const std::vector<ObstaclePoint>& obstacles,
                                    const std::vector<Eigen::Vector2d>& content) {
  ClearRectangle clear{{box.low.array() - margin, box.high.array() + margin}};
  std::vector<bool> given_up(obstacles.size(), false);
  for (;;) {
    int worst = -1;
    Move move;
    for (size_t k = 0; k < obstacles.size(); ++k) {
      if (given_up[k] || !is_too_close(clear.rectangle, obstacles[k])) continue;
      const Move best = find_best_move(box, clear.rectangle, obstacles[k], content);
      if (best.margin < 0.0 && !obstacles[k].may_cut) {
        given_up[k] = true;
        continue;
      }
      const bool leaves_less = best.lost != move.lost ? best.lost > move.lost : best.margin < move.margin;
      if (worst >= 0 && !leaves_less) continue;
      worst = static_cast<int>(k);
      move = best;
    }
    if (worst < 0) return clear;
    side_of(clear.rectangle, move.side) = move.to;
    clear.obstacle_of_side[move.side] = worst;
    if (!(clear.rectangle.low.array() < clear.rectangle.high.array()).all()) return clear;
  }
}

}  // namespace lipofill::geometry
