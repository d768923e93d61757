#include "core/mechanics/tissue_setup.h"

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <utility>

#include "core/model/shared_parts.h"

namespace lipofill::mechanics {
namespace {

using coupling::SplitMesh;
using geometry::LayeredGrid;

/// Holds nodes as a support says. `axis`: the direction that rollers block.
class SupportBuilder {
 public:
  SupportBuilder(const LayeredGrid& grid, const SplitMesh& split) : grid_(grid), split_(split) {
    supports_.fixed.assign(split.mesh.n_nodes(), {false, false, false});
    supports_.spring.assign(split.mesh.n_nodes(), 0.0);
    for (const int node : split.bone_nodes) supports_.fixed[node] = {true, true, true};
  }

  void hold_face(const model::Support& support, int axis, const std::vector<std::array<int, 4>>& quads) {
    if (support.kind == model::SupportKind::kFree || support.kind == model::SupportKind::kByRegion) return;
    for (const std::array<int, 4>& quad : quads) {
      for (const int node : quad) {
        if (support.kind == model::SupportKind::kClamped) supports_.fixed[node] = {true, true, true};
        if (support.kind == model::SupportKind::kRollers) supports_.fixed[node][axis] = true;
        if (support.kind == model::SupportKind::kElastic)
          supports_.spring[node] += 0.25 * support.stiffness * area(quad);
      }
    }
  }

  /// Holds the deep face by its give c: the springs of what lies beneath and of bone, which gives
  /// nothing, in series, so that their stiffness per area is `stiffness` / c.
  void hold_by_give(double stiffness, const Eigen::VectorXd& give) {
    const std::vector<std::array<int, 4>> quads = base();
    for (size_t q = 0; q < quads.size(); ++q) {
      const int i = static_cast<int>(q) % grid_.n_xi;
      const int j = static_cast<int>(q) / grid_.n_xi;
      const std::array<int, 4> places = {grid_.surface_index(i, j), grid_.surface_index(i + 1, j),
                                         grid_.surface_index(i + 1, j + 1), grid_.surface_index(i, j + 1)};
      for (size_t c = 0; c < 4; ++c) {
        const double here = give[places[c]];
        if (here <= model::kLeastGive) {
          supports_.fixed[quads[q][c]] = {true, true, true};
        } else {
          supports_.spring[quads[q][c]] += 0.25 * stiffness / here * area(quads[q]);
        }
      }
    }
  }

  /// Quadrilaterals of the side i = 0 or n_xi (`along_eta`) or j = 0 or n_eta; through all levels,
  /// both copies of doubled nodes.
  std::vector<std::array<int, 4>> side(bool along_eta, bool high) const {
    std::vector<std::array<int, 4>> quads;
    const int count = along_eta ? grid_.n_eta : grid_.n_xi;
    for (int level = 0; level + 1 < grid_.n_levels(); ++level) {
      for (int k = 0; k < count; ++k) {
        const int a = side_place(along_eta, high, k);
        const int b = side_place(along_eta, high, k + 1);
        quads.push_back({inner(level, a), inner(level, b), outer(level + 1, b), outer(level + 1, a)});
      }
    }
    return quads;
  }

  /// Quadrilaterals of the deep face that rest on the base; where a film lies on the base the
  /// tissue is free of it.
  std::vector<std::array<int, 4>> base() const {
    std::vector<std::array<int, 4>> quads;
    const int level = grid_.n_levels() - 1;
    for (int j = 0; j < grid_.n_eta; ++j) {
      for (int i = 0; i < grid_.n_xi; ++i) {
        quads.push_back({inner(level, grid_.surface_index(i, j)), inner(level, grid_.surface_index(i + 1, j)),
                         inner(level, grid_.surface_index(i + 1, j + 1)), inner(level, grid_.surface_index(i, j + 1))});
      }
    }
    return quads;
  }

  solid::NodeSupports take() { return std::move(supports_); }

 private:
  int outer(int level, int place) const { return split_.outer_node[level * grid_.nodes_per_level() + place]; }
  int inner(int level, int place) const { return split_.inner_node[level * grid_.nodes_per_level() + place]; }
  int side_place(bool along_eta, bool high, int k) const {
    return along_eta ? grid_.surface_index(high ? grid_.n_xi : 0, k) : grid_.surface_index(k, high ? grid_.n_eta : 0);
  }
  double area(const std::array<int, 4>& quad) const {
    const auto x = [&](int c) { return split_.mesh.rest_positions.col(quad[c]); };
    return 0.5 * Eigen::Vector3d(x(2) - x(0)).cross(Eigen::Vector3d(x(3) - x(1))).norm();
  }

  const LayeredGrid& grid_;
  const SplitMesh& split_;
  solid::NodeSupports supports_;
};

solid::NodeSupports hold_nodes(const model::FaceModel& model, const SplitMesh& split) {
  SupportBuilder builder(model.geometry.grid, split);
  builder.hold_face(model.base, 2, builder.base());
  if (model.base.kind == model::SupportKind::kByRegion) builder.hold_by_give(model.base.stiffness, model.base_give);
  for (const bool high : {false, true}) {
    builder.hold_face(model.rim, 0, builder.side(true, high));
    builder.hold_face(model.rim, 1, builder.side(false, high));
  }
  return builder.take();
}

coupling::WallNodes walls_at(const LayeredGrid& grid, const SplitMesh& split, int level) {
  const auto begin = static_cast<ptrdiff_t>(level) * grid.nodes_per_level();
  const auto end = begin + grid.nodes_per_level();
  return {{split.outer_node.begin() + begin, split.outer_node.begin() + end},
          {split.inner_node.begin() + begin, split.inner_node.begin() + end}};
}

}  // namespace

HeldMesh hold_mesh(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films) {
  const LayeredGrid& grid = model.geometry.grid;
  std::vector<std::vector<bool>> open(grid.n_levels());
  for (const plan::FilmLayout& film : films) {
    if (film.wall != plan::FilmWallKind::kTissue) continue;
    const std::vector<bool>& of_film = film.bond.open;
    std::vector<bool>& level = open[film.level];
    if (level.empty()) level.assign(grid.nodes_per_level(), false);
    for (size_t s = 0; s < of_film.size(); ++s) level[s] = level[s] || of_film[s];
  }
  HeldMesh held;
  held.split = coupling::split_mesh(grid, open);
  held.supports = hold_nodes(model, held.split);
  for (const plan::FilmLayout& film : films) {
    if (film.wall == plan::FilmWallKind::kTissue) held.walls.push_back(walls_at(grid, held.split, film.level));
  }
  held.skin_nodes = walls_at(grid, held.split, 0).outer;
  return held;
}

absl::StatusOr<TissueSetup> set_up_tissue(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films,
                                          const plan::SimulationSpec& spec) {
  HeldMesh held = hold_mesh(model, films);
  std::vector<FilmOnTissue> films_on_tissue;
  for (const plan::FilmLayout& film : films) {
    if (film.wall == plan::FilmWallKind::kTissue)
      films_on_tissue.push_back({&film, &held.walls[films_on_tissue.size()]});
  }
  auto fibres = place_wall_fibres(model, films_on_tissue, spec.ligaments, held.split.mesh);
  if (!fibres.ok()) return fibres.status();
  std::vector<solid::ElasticMaterial> materials;
  for (const model::TissueLayerSpec& layer : model.layers) materials.push_back(layer.material);
  std::string pattern_key = model::key_of_pattern(held.split.mesh, held.supports, fibres->springs);
  std::string key = model::key_of_tissue(pattern_key, held.split.mesh, materials, held.supports, fibres->springs);
  auto structure = model.shared->tissues.get(key, [&] {
    return solid::TissueStructure::create(std::move(held.split.mesh), materials, std::move(held.supports),
                                          fibres->springs);
  });
  if (!structure.ok()) return structure.status();
  std::vector<double> youngs_moduli = solid::youngs_moduli_of(materials);
  auto tissue =
      solid::Tissue::create(*std::move(structure), youngs_moduli, {spec.damping_mass, spec.damping_stiffness});
  if (!tissue.ok()) return tissue.status();
  return TissueSetup{*std::move(tissue),           std::move(held.walls),  std::move(held.skin_nodes),
                     std::move(fibres->ligaments), std::move(pattern_key), std::move(key),
                     std::move(youngs_moduli)};
}

}  // namespace lipofill::mechanics
