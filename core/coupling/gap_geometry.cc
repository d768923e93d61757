#include "core/coupling/gap_geometry.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lipofill::coupling {
namespace {

const std::array<double, 2> kGauss = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};

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

  /// Pieces come cell by cell.
  void add_piece(const film::CellPiece& piece) {
    if (piece.cell != cell_) wall_place_of_place_.clear();
    cell_ = piece.cell;
    const int lane = n_pieces_++ % kLanes;
    if (lane == 0) result_.batches.emplace_back();
    GapGeometry::Batch& batch = result_.batches.back();
    const geometry::ChartBox& box = piece.box;
    const std::array<double, 2> xi = {box.xi_min, box.xi_max};
    const std::array<double, 2> eta = {box.eta_min, box.eta_max};
    for (int g = 0; g < 2; ++g) {
      batch.s[g][lane] = (xi[0] + kGauss[g] * (xi[1] - xi[0])) * tissue_.n_xi - piece.quad_i;
      batch.t[g][lane] = (eta[0] + kGauss[g] * (eta[1] - eta[0])) * tissue_.n_eta - piece.quad_j;
    }
    const double weight = 0.25 * (xi[1] - xi[0]) * tissue_.n_xi * (eta[1] - eta[0]) * tissue_.n_eta;
    for (int g = 0; g < 4; ++g) batch.weight[g][lane] = piece.share[g] * weight;
    const std::array<int, 4> places = quad_places(tissue_, piece.quad_i, piece.quad_j);
    for (int c = 0; c < 4; ++c) {
      batch.outer[c][lane] = walls_.outer[places[c]];
      batch.inner[c][lane] = walls_.inner[places[c]];
      batch.wall_place[c][lane] = find_wall_place(piece.cell, places[c]);
    }
    batch.cell[lane] = piece.cell;
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
      for (Lanes& weight : batch.weight) weight[lane] = 0.0;
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
  int cell_ = -1;                                     ///< the cell under way
  std::vector<Place> places_;                         ///< those of the walls, cell by cell
  std::unordered_map<int, int> wall_place_of_place_;  ///< serves the cell under way
};

}  // namespace

GapGeometry make_gap_geometry(const geometry::LayeredGrid& tissue, const WallNodes& walls, const film::FilmGrid& film,
                              const std::vector<film::CellPiece>& pieces, const std::vector<int>& dof_of_component,
                              int n_dofs) {
  Builder builder(tissue, walls, film);
  for (const film::CellPiece& piece : pieces) builder.add_piece(piece);
  for (int j = 0; j <= film.n_eta; ++j) {
    for (int i = 0; i <= film.n_xi; ++i) builder.add_vertex(film.vertex_xi(i), film.vertex_eta(j));
  }
  return builder.take(dof_of_component, n_dofs);
}

}  // namespace lipofill::coupling
