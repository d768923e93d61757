#include "server/wire/simulation_conversion.h"

#include <algorithm>

#include "core/anatomy/fat_presets.h"
#include "core/base/units.h"
#include "core/plan/step_rules.h"
#include "server/wire/chart_conversion.h"

namespace lipofill::server {
namespace {

geometry::ChartBox read_box(const v1::ChartBox& message, const FieldReader& reader) {
  return {reader.required(message.has_xi_min(), message.xi_min(), 1.0, "xi_min"),
          reader.required(message.has_xi_max(), message.xi_max(), 1.0, "xi_max"),
          reader.required(message.has_eta_min(), message.eta_min(), 1.0, "eta_min"),
          reader.required(message.has_eta_max(), message.eta_max(), 1.0, "eta_max")};
}

plan::ZoneSpec read_zone(const v1::Zone& message, const FieldReader& reader) {
  plan::ZoneSpec zone;
  zone.name = message.name();
  if (message.name().empty()) reader.missing("name");
  switch (message.shape_case()) {
    case v1::Zone::kBox:
      zone.shape = read_box(message.box(), reader.below("box"));
      break;
    case v1::Zone::kDisc: {
      const FieldReader disc = reader.below("disc");
      zone.shape = plan::Disc{
          read_skin_point(message.disc().centre(), disc.below("centre")),
          disc.required(message.disc().has_radius_mm(), message.disc().radius_mm(), kMetresPerMillimetre, "radius_mm")};
      break;
    }
    case v1::Zone::kRegion:
      zone.shape = plan::NamedRegion{message.region()};
      break;
    case v1::Zone::kPainted:
      zone.shape = plan::PaintedRegion{read_samples(message.painted(), 1.0, reader.below("painted"))};
      break;
    case v1::Zone::SHAPE_NOT_SET:
      reader.wrong("box", "is missing, and so are disc, region and painted: one of them says where the zone is");
  }
  return zone;
}

void read_wall(const v1::FilmWall& message, const FieldReader& reader, plan::FilmSpec& film) {
  switch (message.kind()) {
    case v1::FilmWall::RIGID:
      film.wall = plan::FilmWallKind::kRigid;
      break;
    case v1::FilmWall::WINKLER:
      film.wall = plan::FilmWallKind::kWinkler;
      film.wall_stiffness = reader.required(message.has_stiffness_kpa_per_mm(), message.stiffness_kpa_per_mm(),
                                            kPascalsPerMetrePerKilopascalPerMillimetre, "stiffness_kpa_per_mm");
      break;
    default:
      film.wall = plan::FilmWallKind::kTissue;
  }
}

/// Points of a path or a ligament, the message at `reader`.
template <typename Points>
std::vector<geometry::SkinPoint> read_points(const Points& message, const FieldReader& reader) {
  std::vector<geometry::SkinPoint> points;
  for (int i = 0; i < message.points_size(); ++i) {
    points.push_back(read_skin_point(message.points(i), reader.below("points", i)));
  }
  return points;
}

plan::WallSpec read_wall_in_film(const v1::Wall& message, const FieldReader& reader) {
  plan::WallSpec wall;
  wall.name = message.name();
  if (message.name().empty()) reader.missing("name");
  if (message.has_between()) {
    wall.between = {message.between().first(), message.between().second()};
    if (wall.between[0].empty()) reader.below("between").missing("first");
    if (wall.between[1].empty()) reader.below("between").missing("second");
  } else if (message.has_path()) {
    wall.path = read_points(message.path(), reader.below("path"));
  } else {
    reader.wrong("path", "is missing, and so is between: one of them says where the wall is");
  }
  wall.leakage = message.leakage_ml_per_s_kpa_cm() * kLeakageUnit;
  return wall;
}

plan::ZoneEdgeSpec read_edge(const v1::ZoneEdge& message, const FieldReader& reader) {
  plan::ZoneEdgeSpec edge;
  if (message.outline() == v1::ZoneEdge::CELLS) edge.outline = plan::ZoneOutline::kCells;
  if (message.has_rigid()) {
    if (!message.rigid()) reader.wrong("rigid", "is false: leave it out, or give an attachment");
    edge.is_rigid = true;
  }
  if (message.has_attachment()) {
    const v1::Attachment& given = message.attachment();
    const FieldReader attachment = reader.below("attachment");
    edge.attachment = {attachment.required(given.has_stiffness_kpa_per_mm(), given.stiffness_kpa_per_mm(),
                                           kPascalsPerMetrePerKilopascalPerMillimetre, "stiffness_kpa_per_mm"),
                       attachment.required(given.has_width_mm(), given.width_mm(), kMetresPerMillimetre, "width_mm"),
                       given.feathers()};
  }
  return edge;
}

plan::FilmSpec read_film(const v1::Film& message, const FieldReader& reader) {
  plan::FilmSpec film;
  film.name = message.name();
  if (message.name().empty()) reader.missing("name");
  film.below_layer = message.below_layer();
  if (message.has_extent()) film.extent = read_box(message.extent(), reader.below("extent"));
  film.n_xi = reader.count_or_choice(message.has_n_xi(), message.n_xi(), "n_xi");
  film.n_eta = reader.count_or_choice(message.has_n_eta(), message.n_eta(), "n_eta");
  for (int i = 0; i < message.zones_size(); ++i) {
    film.zones.push_back(read_zone(message.zones(i), reader.below("zones", i)));
  }
  if (message.has_rest_thickness_mm()) {
    film.rest_thickness =
        read_scalar_field(message.rest_thickness_mm(), kMetresPerMillimetre, reader.below("rest_thickness_mm"));
  }
  if (message.has_initial_thickness_mm()) {
    film.initial_thickness =
        read_scalar_field(message.initial_thickness_mm(), kMetresPerMillimetre, reader.below("initial_thickness_mm"));
  }
  const bool frictionless = message.wall_friction() == v1::NONE;
  film.wall_friction = frictionless ? film::WallFriction::kNone : film::WallFriction::kNoSlip;
  read_wall(message.wall(), reader.below("wall"), film);
  for (int i = 0; i < message.walls_size(); ++i) {
    film.walls.push_back(read_wall_in_film(message.walls(i), reader.below("walls", i)));
  }
  film.connective_tissue = {
      message.connective_tissue().stiffness_kpa_per_mm() * kPascalsPerMetrePerKilopascalPerMillimetre,
      message.connective_tissue().entry_pressure_pa()};
  film.edge = read_edge(message.edge(), reader.below("edge"));
  return film;
}

plan::InjectionSpec read_injection(const v1::Injection& message, const FieldReader& reader) {
  plan::InjectionSpec injection;
  injection.zone = message.zone();
  if (message.zone().empty()) reader.missing("zone");
  injection.volume =
      reader.required(message.has_volume_ml(), message.volume_ml(), kCubicMetresPerMillilitre, "volume_ml");
  injection.rate =
      reader.required(message.has_rate_ml_per_s(), message.rate_ml_per_s(), kCubicMetresPerMillilitre, "rate_ml_per_s");
  if (message.has_start_s()) injection.start = message.start_s();
  if (message.has_site()) injection.site = read_skin_point(message.site(), reader.below("site"));
  return injection;
}

void read_time(const v1::TimeControl& message, plan::SimulationSpec& spec) {
  if (message.goal() == v1::TimeControl::SETTLED_SHAPE) spec.goal = plan::TimeGoal::kSettledShape;
  if (message.has_step_ms()) spec.step = message.step_ms() * kSecondsPerMillisecond;
  const plan::TimeFigures figures = plan::figures_of(spec.goal);
  if (figures.max_step.has_value()) spec.max_step = std::max(spec.step, *figures.max_step);
  if (figures.max_injection_step.has_value())
    spec.max_injection_step = std::max(spec.step, *figures.max_injection_step);
  spec.error_tolerance = figures.error_tolerance;
  if (message.has_max_step_ms()) spec.max_step = message.max_step_ms() * kSecondsPerMillisecond;
  if (message.has_max_injection_step_ms()) {
    spec.max_injection_step = message.max_injection_step_ms() * kSecondsPerMillisecond;
  }
  if (message.has_end_s()) spec.end = message.end_s();
  if (message.has_settle_skin_speed_mm_per_s()) {
    spec.settle_skin_speed = message.settle_skin_speed_mm_per_s() * kMetresPerMillimetre;
  }
  if (message.has_error_tolerance_mm()) spec.error_tolerance = message.error_tolerance_mm() * kMetresPerMillimetre;
}

anatomy::FatPreset to_fat_preset(v1::FatPreset preset) {
  switch (preset) {
    case v1::COLEMAN:
      return anatomy::FatPreset::kColeman;
    case v1::NANOFAT:
      return anatomy::FatPreset::kNanofat;
    case v1::SVF_GEL:
      return anatomy::FatPreset::kSvfGel;
    default:
      return anatomy::FatPreset::kNewtonian;
  }
}

void read_fat(const v1::Fat& message, const FieldReader& reader, plan::SimulationSpec& spec) {
  const anatomy::FatFigures figures = anatomy::figures_of(to_fat_preset(message.preset()));
  spec.fat_flow_index = message.has_flow_index() ? message.flow_index() : figures.flow_index;
  spec.fat_viscosity = figures.consistency;
  if (message.has_viscosity_pa_s()) spec.fat_viscosity = message.viscosity_pa_s();
  if (message.has_consistency_pa_s_n()) spec.fat_viscosity = message.consistency_pa_s_n();
  if (message.has_viscosity_pa_s() && spec.fat_flow_index != 1.0) {
    reader.wrong("viscosity_pa_s", "is given, but with a flow index below 1 it is consistency_pa_s_n");
  }
  if (message.has_consistency_pa_s_n() && spec.fat_flow_index == 1.0) {
    reader.wrong("consistency_pa_s_n", "is given, but with flow index 1 it is viscosity_pa_s");
  }
  const bool figures_are_of_another_law = !message.has_consistency_pa_s_n() && !message.has_viscosity_pa_s() &&
                                          message.has_flow_index() && message.flow_index() <= 1.0 &&
                                          message.flow_index() != figures.flow_index;
  if (figures_are_of_another_law) {
    reader.wrong(message.flow_index() < 1.0 ? "consistency_pa_s_n" : "viscosity_pa_s",
                 "is missing: that of the preset goes with its own flow index");
  }
  spec.fat_yield_stress = message.has_yield_stress_pa() ? message.yield_stress_pa() : figures.yield_stress;
  if (figures.shear_modulus > 0.0) spec.fat_shear_modulus = figures.shear_modulus;
  if (message.has_shear_modulus_pa()) spec.fat_shear_modulus = message.shear_modulus_pa();
  spec.fat_density = message.has_density_kg_m3() ? message.density_kg_m3() : figures.density;
}

plan::LigamentSpec read_ligament(const v1::Ligament& message, const FieldReader& reader) {
  plan::LigamentSpec ligament;
  ligament.name = message.name();
  if (message.name().empty()) reader.missing("name");
  ligament.film = message.film();
  ligament.inner_film = message.inner_film();
  if (message.place_case() == v1::Ligament::kAnatomical) {
    ligament.place = plan::NamedLigament{message.anatomical()};
  } else if (message.place_case() == v1::Ligament::kPoints) {
    ligament.place = read_points(message.points(), reader.below("points"));
    if (!message.has_stiffness_n_per_mm()) reader.missing("stiffness_n_per_mm");
  } else {
    reader.wrong("points", "are missing, and so is anatomical: one of them says where the ligament is");
  }
  if (message.has_stiffness_n_per_mm()) {
    ligament.stiffness = message.stiffness_n_per_mm() * kNewtonsPerMetrePerNewtonPerMillimetre;
  }
  ligament.slack = message.slack_mm() * kMetresPerMillimetre;
  if (message.has_breaking_force_n()) ligament.breaking_force = message.breaking_force_n();
  return ligament;
}

plan::ProbeSpec read_probe(const v1::Probe& message, const FieldReader& reader) {
  if (message.name().empty()) reader.missing("name");
  return {message.name(), message.film(), read_skin_point(message.place(), reader.below("place"))};
}

}  // namespace

absl::StatusOr<plan::SimulationSpec> to_simulation_spec(const v1::SimulationSpec& message) {
  FieldViolations violations;
  const FieldReader reader("", violations);
  plan::SimulationSpec spec;
  if (message.model().empty()) reader.missing("model");
  read_fat(message.fat(), reader.below("fat"), spec);
  if (message.has_suction_limit_pa()) spec.suction_limit = message.suction_limit_pa();
  for (int i = 0; i < message.films_size(); ++i) {
    spec.films.push_back(read_film(message.films(i), reader.below("films", i)));
  }
  for (int i = 0; i < message.injections_size(); ++i) {
    spec.injections.push_back(read_injection(message.injections(i), reader.below("injections", i)));
  }
  read_time(message.time(), spec);
  const bool lumped = message.coupling() == v1::LUMPED;
  spec.coupling = lumped ? plan::CouplingMode::kLumped : plan::CouplingMode::kExact;
  if (message.has_gravity_m_s2()) spec.gravity = read_vector(message.gravity_m_s2(), 1.0, reader.below("gravity_m_s2"));
  spec.damping_mass = message.damping().mass_per_s();
  spec.damping_stiffness = message.damping().stiffness_s();
  for (int i = 0; i < message.probes_size(); ++i) {
    spec.probes.push_back(read_probe(message.probes(i), reader.below("probes", i)));
  }
  for (int i = 0; i < message.ligaments_size(); ++i) {
    spec.ligaments.push_back(read_ligament(message.ligaments(i), reader.below("ligaments", i)));
  }
  if (!violations.empty()) return violations.to_status();
  return spec;
}

absl::StatusOr<plan::InjectionSpec> to_injection_spec(const v1::Injection& message) {
  FieldViolations violations;
  plan::InjectionSpec spec = read_injection(message, FieldReader("", violations));
  if (!violations.empty()) return violations.to_status();
  return spec;
}

}  // namespace lipofill::server
