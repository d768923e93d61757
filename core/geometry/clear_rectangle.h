#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace lipofill::geometry {

/// A rectangle of the plane, its sides along the axes.
struct Rectangle {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Zero();

  bool contains(const Eigen::Vector2d& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
};

/// A point that a rectangle should not hold.
struct ObstaclePoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double clearance = 0.0;  ///< least distance from the rectangle
  bool may_cut = false;    ///< the rectangle gives up some of what it should hold, rather than hold this
};

/// The rectangle tells what became of a side: the rectangle's, in the order low x, high x, low y,
/// high y.
struct ClearRectangle {
  Rectangle rectangle;
  /// The obstacle that each side moved in for, -1 where none did.
  std::array<int, 4> obstacle_of_side{-1, -1, -1, -1};
};

/// The rectangle `box` with a margin around it, its sides moved in until it is clear of the
/// obstacles. Of the four sides that can clear an obstacle the one that keeps most margin moves;
/// the obstacles that leave least come first. One that can only be cleared by a side within the box
/// stays inside, unless it may cut: then the side moves that loses the fewest of the `content`
/// points. Checked by tests/unit/geometry/chart_around_test.cc.
ClearRectangle find_clear_rectangle(const Rectangle& box, double margin, const std::vector<ObstaclePoint>& obstacles,
                                    const std::vector<Eigen::Vector2d>& content);

}  // namespace lipofill::geometry
