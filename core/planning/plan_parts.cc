#include "core/planning/plan_parts.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "core/plan/plan_placement.h"

namespace lipofill::planning {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// The middle of each cell of a film, on the skin at rest.
Eigen::Matrix3Xd find_middles(const geometry::LayeredGrid& grid, const film::FilmGrid& film) {
  const Eigen::Matrix3Xd corners = plan::vertices_on_skin(grid, film);
  Eigen::Matrix3Xd middles(3, film.n_cells());
  for (int cell = 0; cell < film.n_cells(); ++cell) {
    const int slot = film.slot_of_cell[static_cast<size_t>(cell)];
    const int i = slot % film.n_xi, j = slot / film.n_xi;
    middles.col(cell) = 0.25 * (corners.col(film.vertex(i, j)) + corners.col(film.vertex(i + 1, j)) +
                                corners.col(film.vertex(i, j + 1)) + corners.col(film.vertex(i + 1, j + 1)));
  }
  return middles;
}

}  // namespace

absl::StatusOr<PartPlace> place_part(const model::FaceModel& model, const plan::SimulationSpec& plan) {
  plan::PlacedPlan placed;
  if (const absl::Status status = plan::place_plan(model, plan, nullptr, placed); !status.ok()) return status;
  PartPlace place;
  for (const geometry::Rider& rider : model.geometry.riders) place.skin.push_back(rider.vertex);
  place.fat.resize(3, 0);
  for (const plan::FilmLayout& film : placed.films) {
    const Eigen::Matrix3Xd middles = find_middles(model.geometry.grid, film.grid);
    Eigen::Matrix3Xd all(3, place.fat.cols() + middles.cols());
    all << place.fat, middles;
    place.fat = std::move(all);
  }
  return place;
}

double find_distance(const PartPlace& one, const PartPlace& other) {
  double least = kFar;
  for (const auto& place : one.fat.colwise()) {
    if (other.fat.cols() > 0) least = std::min(least, (other.fat.colwise() - place).colwise().norm().minCoeff());
  }
  return least;
}

int count_shared_vertices(const PartPlace& one, const PartPlace& other) {
  std::vector<int> shared;
  std::set_intersection(one.skin.begin(), one.skin.end(), other.skin.begin(), other.skin.end(),
                        std::back_inserter(shared));
  return static_cast<int>(shared.size());
}

std::vector<size_t> group_touching(const std::vector<PartPlace>& parts) {
  std::vector<size_t> group(parts.size());
  std::iota(group.begin(), group.end(), size_t{0});
  for (size_t a = 0; a < parts.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      if (find_distance(parts[a], parts[b]) > kTouching) continue;
      const size_t low = std::min(group[a], group[b]);
      const size_t high = std::max(group[a], group[b]);
      std::replace(group.begin(), group.end(), high, low);
    }
  }
  return group;
}

double find_widest_gap(const std::vector<PartPlace>& parts) {
  double widest = 0.0;
  for (size_t a = 0; a < parts.size(); ++a) {
    double least = kFar;
    for (size_t b = 0; b < parts.size(); ++b) {
      if (a != b) least = std::min(least, find_distance(parts[a], parts[b]));
    }
    widest = std::max(widest, least);
  }
  return widest;
}

}  // namespace lipofill::planning
