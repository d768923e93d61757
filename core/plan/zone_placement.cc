#include "core/plan/zone_placement.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/geometry/cut_rectangle.h"
#include "core/plan/zone_attachment.h"
#include "core/plan/zone_levels.h"
#include "core/plan/zone_share.h"

namespace lipofill::plan {
namespace {

using film::SlotCover;
using geometry::ChartPoint;
using geometry::Level;

/// Share of a slot that makes a cell of its own: thinner ones would have pressures of hardly any
/// weight.
constexpr double kLeastOfCell = 0.25;
/// Less than this share of the zones is not told of.
constexpr double kToldShare = 0.002;
/// Fat whose way ends at the film's extent along less than this is not told of [m].
constexpr double kToldLength = 1e-3;

double share_of(const SlotCover& cover) {
  return 0.25 * std::accumulate(cover.begin(), cover.end(), 0.0);
}

/// The extent of slots [i0, i1] x [j0, j1], where whole numbers are the grid's lines.
ChartBox box_of(const FilmSpec& spec, double i0, double i1, double j0, double j1) {
  const auto xi = [&](double i) {
    return spec.extent.xi_min + (spec.extent.xi_max - spec.extent.xi_min) * i / spec.n_xi;
  };
  const auto eta = [&](double j) {
    return spec.extent.eta_min + (spec.extent.eta_max - spec.extent.eta_min) * j / spec.n_eta;
  };
  return {xi(i0), xi(i1), eta(j0), eta(j1)};
}

/// The levels of a zone's shape, all of them positive inside.
using Shape = std::vector<Level>;

double least_at(const Shape& shape, const ChartPoint& p) {
  double least = shape.front()(p);
  for (const Level& level : shape) least = std::min(least, level(p));
  return least;
}

/// Levels that are all positive where a zone is inside its shape and outside those of earlier
/// zones.
std::vector<Level> levels_of_own_part(const std::vector<Shape>& shapes, size_t zone) {
  std::vector<Level> levels = shapes[zone];
  for (size_t earlier = 0; earlier < zone; ++earlier) {
    levels.emplace_back([shape = shapes[earlier]](const ChartPoint& p) { return -least_at(shape, p); });
  }
  return levels;
}

/// The least of some levels, within the film's extent.
Level least_of(const FilmSpec& spec, const std::vector<Level>& levels) {
  return [extent = spec.extent, levels](const ChartPoint& p) {
    return std::min({p.xi - extent.xi_min, extent.xi_max - p.xi, p.eta - extent.eta_min, extent.eta_max - p.eta,
                     least_at(levels, p)});
  };
}

std::vector<Shape> make_shapes(const model::FaceModel& model, const FilmSpec& spec, FieldViolations& violations,
                               std::vector<std::string>& remarks) {
  std::vector<Shape> shapes;
  std::set<std::string> names;
  for (size_t z = 0; z < spec.zones.size(); ++z) {
    const std::string field = absl::StrCat("zones[", z, "]");
    if (spec.zones[z].name.empty()) violations.add(field + ".name", "is empty");
    if (!names.insert(spec.zones[z].name).second) {
      violations.add(field + ".name", absl::StrCat("is '", spec.zones[z].name, "' a second time"));
    }
    const auto shape = make_zone_levels(model.geometry, spec.zones[z]);
    violations.absorb(field, shape.status());
    if (!shape.ok()) continue;
    shapes.push_back(*shape);
    judge_zone_share(model, spec, spec.zones[z], field, violations, remarks);
  }
  return shapes;
}

/// Cover of every slot by every zone.
class Covers {
 public:
  Covers(const FilmSpec& spec, const std::vector<std::vector<Level>>& cutting) : spec_(spec) {
    for (const std::vector<Level>& levels : cutting) {
      std::vector<SlotCover>& of_zone = of_zone_.emplace_back();
      for (int slot = 0; slot < spec.n_xi * spec.n_eta; ++slot) of_zone.push_back(cover_slot(slot, levels));
    }
  }
  const SlotCover& of(int zone, int slot) const { return of_zone_[zone][slot]; }
  int n_zones() const { return static_cast<int>(of_zone_.size()); }

 private:
  SlotCover cover_slot(int slot, const std::vector<Level>& levels) const {
    const int i = slot % spec_.n_xi;
    const int j = slot / spec_.n_xi;
    SlotCover cover;
    for (int q = 0; q < 4; ++q) {
      const double s = 0.5 * (q & 1);
      const double t = 0.5 * (q >> 1);
      cover[q] = geometry::integrate_inside(box_of(spec_, i + s, i + s + 0.5, j + t, j + t + 0.5), levels).one;
    }
    return cover;
  }

  const FilmSpec& spec_;
  std::vector<std::vector<SlotCover>> of_zone_;
};

/// The slot beside this one whose cell takes a fragment of the zone: the one that the zone covers
/// most, a neighbour across a side before one across a corner; -1: there is none.
int find_taker(const FilmSpec& spec, const PlacedZones& placed, int slot, int zone) {
  const int i = slot % spec.n_xi;
  const int j = slot / spec.n_xi;
  for (const bool across_corner : {false, true}) {
    int taker = -1;
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        if ((di == 0 && dj == 0) || (di != 0 && dj != 0) != across_corner) continue;
        if (i + di < 0 || i + di >= spec.n_xi || j + dj < 0 || j + dj >= spec.n_eta) continue;
        const int beside = (j + dj) * spec.n_xi + i + di;
        if (placed.zone_of_slot[beside] != zone) continue;
        if (taker < 0 || share_of(placed.cover[beside]) > share_of(placed.cover[taker])) taker = beside;
      }
    }
    if (taker >= 0) return taker;
  }
  return -1;
}

void give_slots_to_zones(const FilmSpec& spec, const Covers& covers, PlacedZones& placed) {
  for (int slot = 0; slot < spec.n_xi * spec.n_eta; ++slot) {
    double most = kLeastOfCell;
    for (int zone = 0; zone < covers.n_zones(); ++zone) {
      const double share = share_of(covers.of(zone, slot));
      if (share < most || (placed.zone_of_slot[slot] >= 0 && share == most)) continue;
      most = share;
      placed.zone_of_slot[slot] = zone;
      placed.cover[slot] = covers.of(zone, slot);
    }
  }
}

/// A zone that covers a quarter of no slot has the one it covers most, if that is free.
void place_small_zones(const Covers& covers, PlacedZones& placed) {
  for (int zone = 0; zone < covers.n_zones(); ++zone) {
    if (std::find(placed.zone_of_slot.begin(), placed.zone_of_slot.end(), zone) != placed.zone_of_slot.end()) continue;
    int best = -1;
    for (size_t slot = 0; slot < placed.zone_of_slot.size(); ++slot) {
      const double share = share_of(covers.of(zone, static_cast<int>(slot)));
      if (placed.zone_of_slot[slot] >= 0 || share <= 0.0) continue;
      if (best < 0 || share > share_of(covers.of(zone, best))) best = static_cast<int>(slot);
    }
    if (best < 0) continue;
    placed.zone_of_slot[best] = zone;
    placed.cover[best] = covers.of(zone, best);
  }
}

void hand_out_fragments(const FilmSpec& spec, const Covers& covers, PlacedZones& placed) {
  for (int slot = 0; slot < spec.n_xi * spec.n_eta; ++slot) {
    for (int zone = 0; zone < covers.n_zones(); ++zone) {
      const SlotCover& cover = covers.of(zone, slot);
      if (placed.zone_of_slot[slot] == zone || share_of(cover) <= 0.0) continue;
      const int taker = find_taker(spec, placed, slot, zone);
      if (taker >= 0) {
        placed.fragments.push_back({taker, slot, cover});
      } else {
        placed.uncounted += share_of(cover);
      }
    }
  }
}

std::vector<geometry::OutlineLoop> trace(const model::FaceModel& model, const Level& level) {
  return geometry::trace_outline(level, 2 * model.geometry.grid.n_xi, 2 * model.geometry.grid.n_eta);
}

/// Widens what cuts the cells to where fat feathers, where it does.
void feather_zones(const model::FaceModel& model, const FilmSpec& spec, PlacedZones& placed,
                   std::vector<std::string>& remarks) {
  const std::vector<double> widths = find_feather_widths(model, spec);
  if (std::all_of(widths.begin(), widths.end(), [](double width) { return width <= 0.0; })) return;
  for (const DrawnZone& zone : placed.drawn) {
    placed.distances.push_back(find_signed_distance(model.geometry.grid, zone));
  }
  const std::vector<Level> levels = feather(placed.drawn, placed.distances, widths);
  for (size_t z = 0; z < levels.size(); ++z) {
    if (widths[z] <= 0.0) continue;
    placed.cutting[z] = {levels[z]};
    placed.outlines[z] = trace(model, least_of(spec, placed.cutting[z]));
    const double cut = measure_cut_feather(model.geometry.grid, spec.extent, placed.distances[z], widths[z]);
    if (cut < kToldLength) continue;
    remarks.push_back(absl::StrFormat(
        "Fat of zone %s would feather %.0f mm beyond its outline; the film ends before that along %.0f mm.",
        spec.zones[z].name, widths[z] / kMetresPerMillimetre, cut / kMetresPerMillimetre));
  }
}

void take_whole_slots(const FilmSpec& spec, const std::vector<Shape>& shapes, PlacedZones& placed) {
  for (int slot = 0; slot < spec.n_xi * spec.n_eta; ++slot) {
    const ChartPoint centre = slot_centre(spec, slot);
    const auto first =
        std::find_if(shapes.begin(), shapes.end(), [&](const Shape& shape) { return least_at(shape, centre) >= 0.0; });
    if (first != shapes.end()) placed.zone_of_slot[slot] = static_cast<int>(first - shapes.begin());
  }
}

}  // namespace

double PlacedZones::uncounted_share() const {
  double counted = 0.0;
  for (size_t slot = 0; slot < zone_of_slot.size(); ++slot)
    counted += zone_of_slot[slot] < 0 ? 0.0 : share_of(cover[slot]);
  for (const film::SlotFragment& fragment : fragments) counted += share_of(fragment.cover);
  return uncounted > 0.0 ? uncounted / (counted + uncounted) : 0.0;
}

PlacedZones place_zones(const model::FaceModel& model, const FilmSpec& spec, FieldViolations& violations,
                        std::vector<std::string>& remarks) {
  PlacedZones placed;
  const size_t n_slots = static_cast<size_t>(spec.n_xi) * spec.n_eta;
  placed.zone_of_slot.assign(n_slots, -1);
  placed.cover.assign(n_slots, film::kWholeSlot);
  const std::vector<Shape> shapes = make_shapes(model, spec, violations, remarks);
  if (shapes.size() < spec.zones.size()) return placed;
  for (size_t z = 0; z < shapes.size(); ++z) {
    placed.cutting.push_back(levels_of_own_part(shapes, z));
    const Level level = least_of(spec, placed.cutting.back());
    placed.drawn.push_back({level, trace(model, level)});
    placed.outlines.push_back(placed.drawn.back().outline);
  }
  feather_zones(model, spec, placed, remarks);
  if (spec.edge.outline == ZoneOutline::kCells) {
    take_whole_slots(spec, placed.cutting, placed);
  } else {
    const Covers covers(spec, placed.cutting);
    give_slots_to_zones(spec, covers, placed);
    place_small_zones(covers, placed);
    hand_out_fragments(spec, covers, placed);
  }
  if (const double share = placed.uncounted_share(); share > kToldShare) {
    remarks.push_back(
        absl::StrFormat("Film %s: slivers that no cell can take make up %.1f %% of its zones; they get no fat. A finer "
                        "film grid has smaller ones.",
                        spec.name, 100.0 * share));
  }
  for (size_t z = 0; z < shapes.size(); ++z) {
    if (std::find(placed.zone_of_slot.begin(), placed.zone_of_slot.end(), static_cast<int>(z)) !=
        placed.zone_of_slot.end())
      continue;
    violations.add(
        absl::StrCat("zones[", z, "]"),
        absl::StrCat("'", spec.zones[z].name,
                     "' claims no film cell: it lies outside the film's extent, or other zones hold its cells"));
  }
  return placed;
}

std::vector<film::CellPiece> cut_at_outlines(std::vector<film::CellPiece> pieces, const film::FilmGrid& grid,
                                             const PlacedZones& zones) {
  std::vector<film::CellPiece> inside;
  for (film::CellPiece& piece : pieces) {
    const int zone = grid.zone_of_cell[piece.cell];
    const geometry::RectangleMoments moments = geometry::integrate_inside(piece.box, zones.cutting[zone]);
    if (moments.one == 0.0) continue;
    piece.share = geometry::fit_gauss_shares(moments);
    inside.push_back(piece);
  }
  return inside;
}

ChartPoint slot_centre(const FilmSpec& spec, int slot) {
  const int i = slot % spec.n_xi;
  const int j = slot / spec.n_xi;
  return {spec.extent.xi_min + (spec.extent.xi_max - spec.extent.xi_min) * (i + 0.5) / spec.n_xi,
          spec.extent.eta_min + (spec.extent.eta_max - spec.extent.eta_min) * (j + 0.5) / spec.n_eta};
}

}  // namespace lipofill::plan
