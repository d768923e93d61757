#include "core/coupling/gap_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lipofill::coupling {
namespace {

using Eigen::Vector3d;

const std::array<double, 2> kGauss = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};

/// Ends of [low, high] and every line k/n strictly between them.
std::vector<double> cut_at_grid_lines(double low, double high, int n) {
  constexpr double kSliver = 1e-9;
  std::vector<double> cuts = {low};
  for (int k = static_cast<int>(std::floor(low * n)) + 1; k < n && static_cast<double>(k) / n < high; ++k) {
    const double line = static_cast<double>(k) / n;
    if (line - cuts.back() > kSliver && high - line > kSliver) cuts.push_back(line);
  }
  cuts.push_back(high);
  return cuts;
}

int interval_of(double value, int n) {
  return std::clamp(static_cast<int>(std::floor(value * n)), 0, n - 1);
}

std::array<double, 4> bilinear(double s, double t) {
  return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
}

std::array<int, 4> quad_places(const geometry::LayeredGrid& grid, int i, int j) {
  return {grid.surface_index(i, j), grid.surface_index(i + 1, j), grid.surface_index(i + 1, j + 1),
          grid.surface_index(i, j + 1)};
}

/// det(a, b, d) integrated over s, and its derivatives by the two walls' tangents and distance.
struct GapIntegrand {
  double value = 0.0;
  std::array<Vector3d, 2> by_xi = {Vector3d::Zero(), Vector3d::Zero()};   ///< by dX/dxi of the outer, inner wall
  std::array<Vector3d, 2> by_eta = {Vector3d::Zero(), Vector3d::Zero()};  ///< by dX/deta
  Vector3d by_distance = Vector3d::Zero();
};

GapIntegrand integrate_through_gap(const Vector3d& outer_xi, const Vector3d& outer_eta, const Vector3d& inner_xi,
                                   const Vector3d& inner_eta, const Vector3d& distance) {
  GapIntegrand gap;
  for (const double s : kGauss) {
    const Vector3d a = s * outer_xi + (1 - s) * inner_xi;
    const Vector3d b = s * outer_eta + (1 - s) * inner_eta;
    const Vector3d normal = a.cross(b);
    const Vector3d by_a = b.cross(distance);
    const Vector3d by_b = distance.cross(a);
    gap.value += 0.5 * normal.dot(distance);
    gap.by_distance += 0.5 * normal;
    gap.by_xi[0] += 0.5 * s * by_a;
    gap.by_xi[1] += 0.5 * (1 - s) * by_a;
    gap.by_eta[0] += 0.5 * s * by_b;
    gap.by_eta[1] += 0.5 * (1 - s) * by_b;
  }
  return gap;
}

}  // namespace

GapVolume::GapVolume(const geometry::LayeredGrid& tissue, WallNodes walls, const film::FilmGrid& film,
                     const std::vector<int>& dof_of_component, int n_dofs)
    : walls_(std::move(walls)), cells_(film.n_cells()), volume_(Eigen::VectorXd::Zero(film.n_cells())) {
  for (int cell = 0; cell < film.n_cells(); ++cell) add_samples(tissue, film, cell);
  number_derivative(dof_of_component, n_dofs);
  for (int j = 0; j <= film.n_eta; ++j) {
    for (int i = 0; i <= film.n_xi; ++i) {
      const double xi = film.vertex_xi(i);
      const double eta = film.vertex_eta(j);
      const int qi = interval_of(xi, tissue.n_xi);
      const int qj = interval_of(eta, tissue.n_eta);
      vertices_.push_back({quad_places(tissue, qi, qj), bilinear(xi * tissue.n_xi - qi, eta * tissue.n_eta - qj)});
    }
  }
}

void GapVolume::add_samples(const geometry::LayeredGrid& tissue, const film::FilmGrid& film, int cell_index) {
  Cell& cell = cells_[cell_index];
  const int slot = film.slot_of_cell[cell_index];
  const int i = film.slot_i(slot);
  const int j = film.slot_j(slot);
  const std::vector<double> xi = cut_at_grid_lines(film.vertex_xi(i), film.vertex_xi(i + 1), tissue.n_xi);
  const std::vector<double> eta = cut_at_grid_lines(film.vertex_eta(j), film.vertex_eta(j + 1), tissue.n_eta);
  std::map<int, int> local_of_place;
  for (size_t b = 0; b + 1 < eta.size(); ++b) {
    for (size_t a = 0; a + 1 < xi.size(); ++a) {
      const int qi = interval_of(0.5 * (xi[a] + xi[a + 1]), tissue.n_xi);
      const int qj = interval_of(0.5 * (eta[b] + eta[b + 1]), tissue.n_eta);
      Sample sample;
      const std::array<int, 4> places = quad_places(tissue, qi, qj);
      for (int c = 0; c < 4; ++c) {
        const auto [entry, is_new] = local_of_place.try_emplace(places[c], static_cast<int>(cell.places.size()));
        if (is_new) cell.places.push_back(places[c]);
        sample.local[c] = entry->second;
      }
      for (const double gt : kGauss) {
        for (const double gs : kGauss) {
          const double s = (xi[a] + gs * (xi[a + 1] - xi[a])) * tissue.n_xi - qi;
          const double t = (eta[b] + gt * (eta[b + 1] - eta[b])) * tissue.n_eta - qj;
          const double nx = tissue.n_xi;
          const double ny = tissue.n_eta;
          sample.n = bilinear(s, t);
          sample.n_xi = {-(1 - t) * nx, (1 - t) * nx, t * nx, -t * nx};
          sample.n_eta = {-(1 - s) * ny, -s * ny, s * ny, (1 - s) * ny};
          sample.weight = 0.25 * (xi[a + 1] - xi[a]) * (eta[b + 1] - eta[b]);
          cell.samples.push_back(sample);
        }
      }
    }
  }
}

void GapVolume::number_derivative(const std::vector<int>& dof_of_component, int n_dofs) {
  const int n_cells = static_cast<int>(cells_.size());
  std::vector<Eigen::Triplet<double>> pattern;
  const auto for_each_entry = [&](auto visit) {
    for (int i = 0; i < n_cells; ++i) {
      for (size_t p = 0; p < cells_[i].places.size(); ++p) {
        const int outer = walls_.outer[cells_[i].places[p]];
        const int inner = walls_.inner[cells_[i].places[p]];
        for (int c = 0; c < 3; ++c)
          visit(cells_[i], i, dof_of_component[3 * outer + c], dof_of_component[3 * inner + c]);
      }
    }
  };
  for_each_entry([&](Cell&, int i, int outer, int inner) {
    if (outer >= 0) pattern.emplace_back(i, outer, 0.0);
    if (inner >= 0) pattern.emplace_back(i, inner, 0.0);
  });
  derivative_.resize(n_cells, n_dofs);
  derivative_.setFromTriplets(pattern.begin(), pattern.end());
  derivative_.makeCompressed();
  const auto slot_of = [&](int row, int column) {
    if (column < 0) return -1;
    const int* rows = derivative_.innerIndexPtr();
    const int* begin = rows + derivative_.outerIndexPtr()[column];
    const int* end = rows + derivative_.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - rows);
  };
  for_each_entry([&](Cell& cell, int i, int outer, int inner) {
    cell.outer_slot.push_back(slot_of(i, outer));
    cell.inner_slot.push_back(slot_of(i, inner));
  });
}

void GapVolume::evaluate(const Eigen::Matrix3Xd& x) {
  derivative_.coeffs().setZero();
  for (size_t i = 0; i < cells_.size(); ++i) volume_[i] = evaluate_cell(x, cells_[i]);
}

double GapVolume::evaluate_cell(const Eigen::Matrix3Xd& x, const Cell& cell) {
  outer_gradient_.setZero(3, cell.places.size());
  inner_gradient_.setZero(3, cell.places.size());
  double volume = 0.0;
  for (const Sample& sample : cell.samples) {
    std::array<Vector3d, 5> sum;  // outer xi, outer eta, inner xi, inner eta, distance
    sum.fill(Vector3d::Zero());
    for (int c = 0; c < 4; ++c) {
      const int place = cell.places[sample.local[c]];
      const auto outer = x.col(walls_.outer[place]);
      const auto inner = x.col(walls_.inner[place]);
      sum[0] += sample.n_xi[c] * outer;
      sum[1] += sample.n_eta[c] * outer;
      sum[2] += sample.n_xi[c] * inner;
      sum[3] += sample.n_eta[c] * inner;
      sum[4] += sample.n[c] * (outer - inner);
    }
    const GapIntegrand gap = integrate_through_gap(sum[0], sum[1], sum[2], sum[3], sum[4]);
    volume += sample.weight * gap.value;
    for (int c = 0; c < 4; ++c) {
      const int local = sample.local[c];
      outer_gradient_.col(local) += sample.weight * (sample.n_xi[c] * gap.by_xi[0] + sample.n_eta[c] * gap.by_eta[0] +
                                                     sample.n[c] * gap.by_distance);
      inner_gradient_.col(local) += sample.weight * (sample.n_xi[c] * gap.by_xi[1] + sample.n_eta[c] * gap.by_eta[1] -
                                                     sample.n[c] * gap.by_distance);
    }
  }
  double* values = derivative_.valuePtr();
  for (size_t k = 0; k < cell.outer_slot.size(); ++k) {
    if (cell.outer_slot[k] >= 0) values[cell.outer_slot[k]] += outer_gradient_.data()[k];
    if (cell.inner_slot[k] >= 0) values[cell.inner_slot[k]] += inner_gradient_.data()[k];
  }
  return volume;
}

Eigen::Matrix3Xd GapVolume::mid_surface(const Eigen::Matrix3Xd& x) const {
  Eigen::Matrix3Xd vertices = Eigen::Matrix3Xd::Zero(3, vertices_.size());
  for (size_t v = 0; v < vertices_.size(); ++v) {
    for (int c = 0; c < 4; ++c) {
      const int place = vertices_[v].places[c];
      vertices.col(v) += 0.5 * vertices_[v].n[c] * (x.col(walls_.outer[place]) + x.col(walls_.inner[place]));
    }
  }
  return vertices;
}

double compute_swept_volume(const geometry::LayeredGrid& grid, const Eigen::Matrix3Xd& rest,
                            const Eigen::Matrix3Xd& current) {
  double volume = 0.0;
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      const std::array<int, 4> p = quad_places(grid, i, j);
      for (const double t : kGauss) {
        for (const double s : kGauss) {
          const auto along_xi = [&](const Eigen::Matrix3Xd& x) -> Vector3d {
            return (1 - t) * (x.col(p[1]) - x.col(p[0])) + t * (x.col(p[2]) - x.col(p[3]));
          };
          const auto along_eta = [&](const Eigen::Matrix3Xd& x) -> Vector3d {
            return (1 - s) * (x.col(p[3]) - x.col(p[0])) + s * (x.col(p[2]) - x.col(p[1]));
          };
          const std::array<double, 4> n = bilinear(s, t);
          Vector3d distance = Vector3d::Zero();
          for (int c = 0; c < 4; ++c) distance += n[c] * (current.col(p[c]) - rest.col(p[c]));
          volume += 0.25 * integrate_through_gap(along_xi(current), along_eta(current), along_xi(rest), along_eta(rest),
                                                 distance)
                               .value;
        }
      }
    }
  }
  return volume;
}

}  // namespace lipofill::coupling
