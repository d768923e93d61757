#include "core/film/advection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lipofill::film {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Tangent vectors of the mid-surface at a point, in index coordinates.
struct Basis {
  Vector3d g1;
  Vector3d g2;
  double sqrt_g;
};

/// Velocity anywhere in the chart, in index coordinates: x = i + fraction, y = j + fraction.
///
/// The tangent vectors are interpolated from the sides of cells, g1 from those along xi and g2 from
/// those along eta: a field without jumps, second order also on the edges. The bilinear tangents of
/// a cell turn and stretch from one cell to the next, and a velocity carried over an edge would
/// lose a little in every step, however short.
class VelocityField {
 public:
  VelocityField(const FilmGrid& grid, const FilmMetric& metric, const std::vector<double>& flux_xi,
                const std::vector<double>& flux_eta)
      : grid_(grid), metric_(metric), flux_xi_(flux_xi), flux_eta_(flux_eta) {}

  Basis basis(const Vector2d& at) const {
    const auto along_xi = [&](int i, int j) { return side(i, j, i + 1, j); };
    const auto along_eta = [&](int i, int j) { return side(i, j, i, j + 1); };
    const double x = move_inside(at.x(), grid_.n_xi);
    const double y = move_inside(at.y(), grid_.n_eta);
    Basis b;
    b.g1 = extend(along_xi, grid_.n_xi, grid_.n_eta + 1, x - 0.5, y);
    b.g2 = extend(along_eta, grid_.n_xi + 1, grid_.n_eta, x, y - 0.5);
    b.sqrt_g = b.g1.cross(b.g2).norm();
    return b;
  }

  /// sqrt(g) u^a, the flux density through lines of constant xi and eta.
  Vector2d flux(const Vector2d& at) const {
    return {sample(flux_xi_, grid_.n_xi + 1, grid_.n_eta, at.x(), at.y() - 0.5),
            sample(flux_eta_, grid_.n_xi, grid_.n_eta + 1, at.x() - 0.5, at.y())};
  }

  Vector2d index_velocity(const Vector2d& at) const { return flux(at) / basis(at).sqrt_g; }

  Vector3d vector(const Vector2d& at) const {
    const Basis b = basis(at);
    const Vector2d f = flux(at);
    return (f.x() * b.g1 + f.y() * b.g2) / b.sqrt_g;
  }

  /// Zone at a point: -1 outside all zones, and for a point that is not finite because of a
  /// velocity beyond all measure.
  int zone(const Vector2d& at) const {
    if (!at.allFinite()) return -1;
    const int i = split(at.x(), grid_.n_xi).first;
    const int j = split(at.y(), grid_.n_eta).first;
    const int cell = grid_.cell_of_slot[j * grid_.n_xi + i];
    return cell < 0 ? -1 : grid_.zone_of_cell[cell];
  }

 private:
  /// Limits a value to [0, n]; a value that is no number becomes 0.
  static double move_inside(double value, int n) { return value > 0.0 ? std::min(value, static_cast<double>(n)) : 0.0; }

  static std::pair<int, double> split(double value, int n) {
    const double inside = move_inside(value, n);
    const int index = std::min(static_cast<int>(inside), n - 1);
    return {index, inside - index};
  }

  Vector3d side(int i, int j, int i_end, int j_end) const {
    return metric_.vertices.col(grid_.vertex(i_end, j_end)) - metric_.vertices.col(grid_.vertex(i, j));
  }

  /// Interpolates bilinearly between samples at integer places, and on to half a cell beyond the
  /// outermost.
  template <typename Sample>
  static Vector3d extend(const Sample& samples, int n_x, int n_y, double x, double y) {
    const int i = std::clamp(static_cast<int>(std::floor(x)), 0, std::max(n_x - 2, 0));
    const int j = std::clamp(static_cast<int>(std::floor(y)), 0, std::max(n_y - 2, 0));
    const double s = n_x > 1 ? x - i : 0.0;
    const double t = n_y > 1 ? y - j : 0.0;
    const int right = std::min(i + 1, n_x - 1);
    const int above = std::min(j + 1, n_y - 1);
    return (1.0 - t) * ((1.0 - s) * samples(i, j) + s * samples(right, j)) +
           t * ((1.0 - s) * samples(i, above) + s * samples(right, above));
  }

  /// Interpolates bilinearly between samples at integer places, constant beyond the outermost.
  static double sample(const std::vector<double>& values, int n_x, int n_y, double x, double y) {
    const auto [i, s] = n_x > 1 ? split(x, n_x - 1) : std::pair(0, 0.0);
    const auto [j, t] = n_y > 1 ? split(y, n_y - 1) : std::pair(0, 0.0);
    const int right = std::min(i + 1, n_x - 1);
    const int above = std::min(j + 1, n_y - 1);
    return (1.0 - t) * ((1.0 - s) * values[j * n_x + i] + s * values[j * n_x + right]) +
           t * ((1.0 - s) * values[above * n_x + i] + s * values[above * n_x + right]);
  }

  const FilmGrid& grid_;
  const FilmMetric& metric_;
  const std::vector<double>& flux_xi_;
  const std::vector<double>& flux_eta_;
};

Vector2d edge_place(const FilmGrid& grid, const Edge& edge) {
  const int slot = grid.slot_of_cell[edge.right];
  const double i = grid.slot_i(slot);
  const double j = grid.slot_j(slot);
  return edge.direction == 0 ? Vector2d(i, j + 0.5) : Vector2d(i + 0.5, j);
}

/// Pulls the foot of a path that left the zone back along the path.
Vector2d stay_in_zone(const VelocityField& field, const Vector2d& start, Vector2d foot, int zone) {
  constexpr int kHalvings = 20;
  for (int k = 0; k < kHalvings && field.zone(foot) != zone; ++k) foot = 0.5 * (start + foot);
  return field.zone(foot) == zone ? foot : start;
}

}  // namespace

Eigen::VectorXd advect_velocity(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& velocity,
                                double dt) {
  Eigen::VectorXd next;
  Advection(grid).advance(metric, velocity, dt, next);
  return next;
}

Advection::Advection(const FilmGrid& grid)
    : grid_(&grid), flux_xi_((grid.n_xi + 1) * grid.n_eta, 0.0), flux_eta_(grid.n_xi * (grid.n_eta + 1), 0.0) {}

void Advection::advance(const FilmMetric& metric, const Eigen::VectorXd& velocity, double dt, Eigen::VectorXd& next) {
  const FilmGrid& grid = *grid_;
  for (int e = 0; e < grid.n_edges(); ++e) {
    const int slot = grid.slot_of_cell[grid.edges[e].right];
    const bool along_xi = grid.edges[e].direction == 0;
    const int place = along_xi ? grid.slot_j(slot) * (grid.n_xi + 1) + grid.slot_i(slot) : slot;
    (along_xi ? flux_xi_ : flux_eta_)[place] = velocity[e];
  }
  const VelocityField field(grid, metric, flux_xi_, flux_eta_);
  next.resize(grid.n_edges());
  for (int e = 0; e < grid.n_edges(); ++e) {
    const Edge& edge = grid.edges[e];
    const int zone = grid.zone_of_cell[edge.left];
    const Vector2d start = edge_place(grid, edge);
    const Vector2d middle = stay_in_zone(field, start, start - 0.5 * dt * field.index_velocity(start), zone);
    const Vector2d foot = stay_in_zone(field, start, start - dt * field.index_velocity(middle), zone);
    const Vector3d carried = field.vector(foot);
    const Basis b = field.basis(start);
    const double g11 = b.g1.squaredNorm();
    const double g12 = b.g1.dot(b.g2);
    const double g22 = b.g2.squaredNorm();
    const double v1 = carried.dot(b.g1);
    const double v2 = carried.dot(b.g2);
    // sqrt(g) u^a = sqrt(g) g^ab v_b
    next[e] = (edge.direction == 0 ? g22 * v1 - g12 * v2 : g11 * v2 - g12 * v1) / b.sqrt_g;
  }
}

}  // namespace lipofill::film
