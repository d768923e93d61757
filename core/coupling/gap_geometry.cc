#include "core/coupling/gap_geometry.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lipofill::coupling {
namespace {

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

std::array<int, 4> quad_places(const geometry::LayeredGrid& grid, int i, int j) {
  return {grid.surface_index(i, j), grid.surface_index(i + 1, j), grid.surface_index(i + 1, j + 1),
          grid.surface_index(i, j + 1)};
}

class Builder {
 public:
  Builder(const geometry::LayeredGrid& tissue, const WallNodes& walls, const film::FilmGrid& film)
      : tissue_(tissue), walls_(walls), film_(film) {}

  void add_cell(int cell) {
    const int slot = film_.slot_of_cell[cell];
    const int i = film_.slot_i(slot);
    const int j = film_.slot_j(slot);
    const std::vector<double> xi = cut_at_grid_lines(film_.vertex_xi(i), film_.vertex_xi(i + 1), tissue_.n_xi);
    const std::vector<double> eta = cut_at_grid_lines(film_.vertex_eta(j), film_.vertex_eta(j + 1), tissue_.n_eta);
    wall_place_of_place_.clear();
    for (size_t b = 0; b + 1 < eta.size(); ++b) {
      for (size_t a = 0; a + 1 < xi.size(); ++a) add_piece(cell, {xi[a], xi[a + 1]}, {eta[b], eta[b + 1]});
    }
  }

  void add_vertex(double xi, double eta) {
    const int i = interval_of(xi, tissue_.n_xi);
    const int j = interval_of(eta, tissue_.n_eta);
    const double s = xi * tissue_.n_xi - i;
    const double t = eta * tissue_.n_eta - j;
    const std::array<int, 4> places = quad_places(tissue_, i, j);
    GapGeometry::Vertex vertex;
    for (int c = 0; c < 4; ++c) {
      vertex.outer[c] = walls_.outer[places[c]];
      vertex.inner[c] = walls_.inner[places[c]];
    }
    vertex.weight = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
    result_.vertices.push_back(vertex);
  }

  GapGeometry take(const std::vector<int>& dof_of_component, int n_dofs) {
    fill_up_last_batch();
    result_.n_cells = film_.n_cells();
    number_derivative(dof_of_component, n_dofs);
    return std::move(result_);
  }

 private:
  struct Place {
    int cell, outer, inner;
  };

  void add_piece(int cell, std::array<double, 2> xi, std::array<double, 2> eta) {
    const int lane = n_pieces_++ % kLanes;
    if (lane == 0) result_.batches.emplace_back();
    GapGeometry::Batch& batch = result_.batches.back();
    const int i = interval_of(0.5 * (xi[0] + xi[1]), tissue_.n_xi);
    const int j = interval_of(0.5 * (eta[0] + eta[1]), tissue_.n_eta);
    for (int g = 0; g < 2; ++g) {
      batch.s[g][lane] = (xi[0] + kGauss[g] * (xi[1] - xi[0])) * tissue_.n_xi - i;
      batch.t[g][lane] = (eta[0] + kGauss[g] * (eta[1] - eta[0])) * tissue_.n_eta - j;
    }
    batch.weight[lane] = 0.25 * (xi[1] - xi[0]) * tissue_.n_xi * (eta[1] - eta[0]) * tissue_.n_eta;
    const std::array<int, 4> places = quad_places(tissue_, i, j);
    for (int c = 0; c < 4; ++c) {
      batch.outer[c][lane] = walls_.outer[places[c]];
      batch.inner[c][lane] = walls_.inner[places[c]];
      batch.wall_place[c][lane] = find_wall_place(cell, places[c]);
    }
    batch.cell[lane] = cell;
  }

  int find_wall_place(int cell, int place) {
    const auto [entry, is_new] = wall_place_of_place_.try_emplace(place, static_cast<int>(places_.size()));
    if (is_new) places_.push_back({cell, walls_.outer[place], walls_.inner[place]});
    return entry->second;
  }

  void fill_up_last_batch() {
    for (int lane = n_pieces_ % kLanes; lane > 0 && lane < kLanes; ++lane) {
      GapGeometry::Batch& batch = result_.batches.back();
      for (int g = 0; g < 2; ++g) {
        batch.s[g][lane] = batch.s[g][0];
        batch.t[g][lane] = batch.t[g][0];
      }
      batch.weight[lane] = 0.0;
      for (int c = 0; c < 4; ++c) {
        batch.outer[c][lane] = batch.outer[c][0];
        batch.inner[c][lane] = batch.inner[c][0];
        batch.wall_place[c][lane] = batch.wall_place[c][0];
      }
      batch.cell[lane] = -1;
    }
  }

  void number_derivative(const std::vector<int>& dof_of_component, int n_dofs) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Place& place : places_) {
      for (const int node : {place.outer, place.inner}) {
        for (int c = 0; c < 3; ++c) {
          const int dof = dof_of_component[3 * node + c];
          if (dof >= 0) entries.emplace_back(place.cell, dof, 0.0);
        }
      }
    }
    Eigen::SparseMatrix<double>& pattern = result_.pattern;
    pattern.resize(film_.n_cells(), n_dofs);
    pattern.setFromTriplets(entries.begin(), entries.end());
    pattern.makeCompressed();
    const auto slot = [&](int cell, int component) -> std::int32_t {
      const int dof = dof_of_component[component];
      if (dof < 0) return -1;
      const int* rows = pattern.innerIndexPtr();
      const int* const begin = rows + pattern.outerIndexPtr()[dof];
      const int* const end = rows + pattern.outerIndexPtr()[dof + 1];
      return static_cast<std::int32_t>(std::lower_bound(begin, end, cell) - rows);
    };
    for (const Place& place : places_) {
      GapGeometry::WallPlace& slots = result_.wall_places.emplace_back();
      for (int c = 0; c < 3; ++c) {
        slots.outer_slot[c] = slot(place.cell, 3 * place.outer + c);
        slots.inner_slot[c] = slot(place.cell, 3 * place.inner + c);
      }
    }
  }

  const geometry::LayeredGrid& tissue_;
  const WallNodes& walls_;
  const film::FilmGrid& film_;
  GapGeometry result_;
  int n_pieces_ = 0;
  std::vector<Place> places_;                         ///< those of the walls, cell by cell
  std::unordered_map<int, int> wall_place_of_place_;  ///< serves the cell under way
};

}  // namespace

GapGeometry make_gap_geometry(const geometry::LayeredGrid& tissue, const WallNodes& walls, const film::FilmGrid& film,
                              const std::vector<int>& dof_of_component, int n_dofs) {
  Builder builder(tissue, walls, film);
  for (int cell = 0; cell < film.n_cells(); ++cell) builder.add_cell(cell);
  for (int j = 0; j <= film.n_eta; ++j) {
    for (int i = 0; i <= film.n_xi; ++i) builder.add_vertex(film.vertex_xi(i), film.vertex_eta(j));
  }
  return builder.take(dof_of_component, n_dofs);
}

}  // namespace lipofill::coupling
