#include "core/plan/zone_bond.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "core/plan/zone_attachment.h"
#include "core/plan/zone_distance.h"

namespace lipofill::plan {
namespace {

using geometry::ChartPoint;
using geometry::LayeredGrid;

constexpr double kRoundOff = 1e-9;
constexpr std::array<double, 2> kGauss = {0.5 - 0.28867513459481288, 0.5 + 0.28867513459481288};

/// Bilinear weights of a quadrilateral's corners, in the order of GapGeometry.
std::array<double, 4> corner_weights(double s, double t) {
  return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
}

/// The cover says what the zones have of each quadrilateral of the level.
struct QuadCover {
  std::vector<std::map<int, double>> zones;    ///< those with a part of it, and its share
  std::vector<std::array<double, 4>> covered;  ///< int N_a over the parts, by corner; 1/4 each where all is covered
};

QuadCover cover_quads(const LayeredGrid& level, const film::FilmGrid& grid,
                      const std::vector<film::CellPiece>& pieces) {
  QuadCover cover;
  const size_t n_quads = static_cast<size_t>(level.n_xi) * level.n_eta;
  cover.zones.resize(n_quads);
  cover.covered.assign(n_quads, {});
  for (const film::CellPiece& piece : pieces) {
    const size_t quad = static_cast<size_t>(piece.quad_j) * level.n_xi + piece.quad_i;
    double& share = cover.zones[quad][grid.zone_of_cell[piece.cell]];
    const double s0 = piece.box.xi_min * level.n_xi - piece.quad_i;
    const double s1 = piece.box.xi_max * level.n_xi - piece.quad_i;
    const double t0 = piece.box.eta_min * level.n_eta - piece.quad_j;
    const double t1 = piece.box.eta_max * level.n_eta - piece.quad_j;
    for (int g = 0; g < 4; ++g) {
      const double weight = 0.25 * piece.share[g] * (s1 - s0) * (t1 - t0);
      share += weight;
      const auto corners = corner_weights(s0 + kGauss[g & 1] * (s1 - s0), t0 + kGauss[g >> 1] * (t1 - t0));
      for (int c = 0; c < 4; ++c) cover.covered[quad][c] += weight * corners[c];
    }
  }
  return cover;
}

/// The zone that has the most of a quadrilateral, -1: none.
int main_zone(const std::map<int, double>& zones) {
  const auto most =
      std::max_element(zones.begin(), zones.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == zones.end() ? -1 : most->first;
}

double total(const std::array<double, 4>& of_corners) {
  return std::accumulate(of_corners.begin(), of_corners.end(), 0.0);
}

/// The attachment around the zones of a film, as a field over the chart.
class AttachmentField {
 public:
  AttachmentField(const model::FaceModel& model, const FilmSpec& spec, const PlacedZones& zones)
      : grid_(model.geometry.grid), zones_(zones.drawn) {
    for (size_t z = 0; z < spec.zones.size(); ++z) {
      distances_.emplace_back(grid_, zones_[z].outline);
      attachments_.push_back(spec.edge.attachment.value_or(assume_attachment(spec.zones[z])));
    }
  }

  /// Stiffness per area [Pa/m]; infinite where the layers are bonded.
  double at(const ChartPoint& place) const {
    const auto inside =
        std::find_if(zones_.begin(), zones_.end(), [&](const DrawnZone& zone) { return zone.level(place) >= 0.0; });
    const Eigen::Vector3d point = geometry::skin_position(grid_, place);
    if (inside == zones_.end()) return outside_zones(point);
    return of_septa(point, static_cast<size_t>(inside - zones_.begin()));
  }

 private:
  double outside_zones(const Eigen::Vector3d& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (size_t z = 0; z < distances_.size(); ++z) {
      const double share = distances_[z].to_outline(point, attachments_[z].width) / attachments_[z].width;
      if (share <= 1.0) least = std::min(least, share * attachments_[z].stiffness);
    }
    return least;
  }

  double of_septa(const Eigen::Vector3d& point, size_t zone) const {
    double sum = 0.0;
    for (size_t z = 0; z < distances_.size(); ++z) {
      if (z == zone) continue;
      const double half = 0.5 * attachments_[z].width;
      const double distance = distances_[z].to_outline(point, half);
      if (distance < half) sum += attachments_[z].stiffness * (1.0 - distance / half);
    }
    return sum;
  }

  const LayeredGrid& grid_;
  const std::vector<DrawnZone>& zones_;
  std::vector<ZoneDistance> distances_;
  std::vector<AttachmentSpec> attachments_;
};

/// The film's slots that a quadrilateral of the tissue overlaps.
std::set<int> slots_under(const LayeredGrid& tissue, const film::FilmGrid& film, int qi, int qj) {
  const ChartBox& box = film.extent;
  const auto to_film = [](double at, double low, double high, int n) { return (at - low) / (high - low) * n; };
  const double x0 = to_film(static_cast<double>(qi) / tissue.n_xi, box.xi_min, box.xi_max, film.n_xi);
  const double x1 = to_film(static_cast<double>(qi + 1) / tissue.n_xi, box.xi_min, box.xi_max, film.n_xi);
  const double y0 = to_film(static_cast<double>(qj) / tissue.n_eta, box.eta_min, box.eta_max, film.n_eta);
  const double y1 = to_film(static_cast<double>(qj + 1) / tissue.n_eta, box.eta_min, box.eta_max, film.n_eta);
  std::set<int> slots;
  for (int j = std::max(0, static_cast<int>(y0 + kRoundOff)); j < std::min(y1 - kRoundOff, 1.0 * film.n_eta); ++j) {
    for (int i = std::max(0, static_cast<int>(x0 + kRoundOff)); i < std::min(x1 - kRoundOff, 1.0 * film.n_xi); ++i) {
      slots.insert(j * film.n_xi + i);
    }
  }
  return slots;
}

/// Visits the quadrilaterals around a place of the level.
void for_each_quad_at(const LayeredGrid& level, int i, int j, const std::function<void(int qi, int qj)>& visit) {
  for (int qj = std::max(j - 1, 0); qj <= std::min(j, level.n_eta - 1); ++qj) {
    for (int qi = std::max(i - 1, 0); qi <= std::min(i, level.n_xi - 1); ++qi) visit(qi, qj);
  }
}

/// True where a wall inside a zone passes between the quadrilaterals around a place.
bool is_on_wall(const LayeredGrid& level, const film::FilmGrid& film, const film::WalledSlots& walls, int i, int j) {
  if (walls.empty()) return false;
  std::set<int> slots;
  for_each_quad_at(level, i, j, [&](int qi, int qj) { slots.merge(slots_under(level, film, qi, qj)); });
  return std::any_of(walls.begin(), walls.end(), [&](const std::pair<int, int>& wall) {
    return slots.contains(wall.first) && slots.contains(wall.second);
  });
}

class BondBuilder {
 public:
  BondBuilder(const model::FaceModel& model, int level, const film::FilmGrid& film, const film::WalledSlots& walls,
              QuadCover cover)
      : model_(model), grid_(model.geometry.grid), level_(level), film_(film), walls_(walls), cover_(std::move(cover)) {
    bond_.open.assign(grid_.nodes_per_level(), false);
    bond_.stiffness.assign(grid_.nodes_per_level(), 0.0);
  }

  /// @param least_cover  share of a quadrilateral that a zone has to have for the layers to part
  ///                     there
  void part_zones_rigidly(double least_cover) {
    open_places([&](int i, int j) {
      std::set<int> zones;
      for_each_quad_at(grid_, i, j, [&](int qi, int qj) {
        const size_t quad = quad_of(qi, qj);
        zones.insert(total(cover_.covered[quad]) >= least_cover ? main_zone(cover_.zones[quad]) : -1);
      });
      return zones.size() == 1 && !zones.contains(-1);
    });
  }

  void tie_uncovered_parts() {
    for_each_quad([&](int qi, int qj) {
      const std::array<double, 4>& covered = cover_.covered[quad_of(qi, qj)];
      if (total(covered) > 1.0 - kRoundOff) return;
      const double area = area_of(qi, qj);
      const double stiffness = rigid_stiffness(area);
      for (int c = 0; c < 4; ++c) add(qi, qj, c, stiffness * area * std::max(0.0, 0.25 - covered[c]));
    });
  }

  void attach_elastically(const AttachmentField& field) {
    std::vector<bool> is_parted(cover_.zones.size());
    std::vector<std::array<double, 4>> shares(cover_.zones.size());
    for_each_quad([&](int qi, int qj) {
      const size_t quad = quad_of(qi, qj);
      bool is_bonded = false;
      for (int g = 0; g < 4; ++g) {
        const double s = kGauss[g & 1];
        const double t = kGauss[g >> 1];
        const double stiffness = field.at({(qi + s) / grid_.n_xi, (qj + t) / grid_.n_eta});
        is_bonded = is_bonded || std::isinf(stiffness);
        const double held = std::isinf(stiffness) ? rigid_stiffness(area_of(qi, qj)) : stiffness;
        const auto corners = corner_weights(s, t);
        for (int c = 0; c < 4; ++c) shares[quad][c] += 0.25 * held * corners[c];
      }
      is_parted[quad] = !is_bonded || !cover_.zones[quad].empty();
    });
    open_places([&](int i, int j) {
      bool all = true;
      for_each_quad_at(grid_, i, j, [&](int qi, int qj) { all = all && is_parted[quad_of(qi, qj)]; });
      return all;
    });
    for_each_quad([&](int qi, int qj) {
      const double area = area_of(qi, qj);
      for (int c = 0; c < 4; ++c) add(qi, qj, c, area * shares[quad_of(qi, qj)][c]);
    });
  }

  ZoneBond take() { return std::move(bond_); }

 private:
  size_t quad_of(int qi, int qj) const { return static_cast<size_t>(qj) * grid_.n_xi + qi; }

  void for_each_quad(const std::function<void(int qi, int qj)>& visit) const {
    for (int qj = 0; qj < grid_.n_eta; ++qj) {
      for (int qi = 0; qi < grid_.n_xi; ++qi) visit(qi, qj);
    }
  }

  void open_places(const std::function<bool(int i, int j)>& parts) {
    for (int j = 0; j <= grid_.n_eta; ++j) {
      for (int i = 0; i <= grid_.n_xi; ++i) {
        bond_.open[grid_.surface_index(i, j)] = parts(i, j) && !is_on_wall(grid_, film_, walls_, i, j);
      }
    }
  }

  void add(int qi, int qj, int corner, double stiffness) {
    const int place = grid_.surface_index(qi + (corner == 1 || corner == 2), qj + (corner >= 2));
    if (bond_.open[place]) bond_.stiffness[place] += stiffness;
  }

  double area_of(int qi, int qj) const {
    const auto x = [&](int i, int j) { return Eigen::Vector3d(grid_.nodes.col(grid_.node(level_, i, j))); };
    return 0.5 * (x(qi + 1, qj + 1) - x(qi, qj)).cross(x(qi, qj + 1) - x(qi + 1, qj)).norm();
  }

  /// E/L [Pa/m], L the side of a quadrilateral of this area.
  double rigid_stiffness(double area) const {
    double modulus = 0.0;
    for (const model::TissueLayerSpec& layer : model_.layers)
      modulus = std::max(modulus, layer.material.youngs_modulus);
    return modulus / std::sqrt(area);
  }

  const model::FaceModel& model_;
  const LayeredGrid& grid_;
  int level_;
  const film::FilmGrid& film_;
  const film::WalledSlots& walls_;
  QuadCover cover_;
  ZoneBond bond_;
};

}  // namespace

ZoneBond bond_around_zones(const model::FaceModel& model, const FilmSpec& spec, int level, const film::FilmGrid& grid,
                           const std::vector<film::CellPiece>& pieces, const film::WalledSlots& walled_slots,
                           const PlacedZones& zones) {
  BondBuilder builder(model, level, grid, walled_slots, cover_quads(model.geometry.grid, grid, pieces));
  if (!has_rigid_edge(model, spec.edge)) {
    builder.attach_elastically(AttachmentField(model, spec, zones));
  } else if (spec.edge.outline == ZoneOutline::kCells) {
    builder.part_zones_rigidly(1.0 - kRoundOff);
  } else {
    builder.part_zones_rigidly(kRoundOff);
    builder.tie_uncovered_parts();
  }
  return builder.take();
}

}  // namespace lipofill::plan
