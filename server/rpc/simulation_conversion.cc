#include "server/rpc/simulation_conversion.h"

#include "server/rpc/chart_conversion.h"

namespace lipofill::server {
namespace {

constexpr double kCubicMetrePerMillilitre = 1e-6;
constexpr double kPascalPerMetrePerKilopascalPerMillimetre = 1e6;
constexpr double kSecondPerMillisecond = 1e-3;

simulation::ChartBox read_box(const v1::ChartBox& message, const FieldReader& reader) {
  return {reader.required(message.has_xi_min(), message.xi_min(), 1.0, "xi_min"),
          reader.required(message.has_xi_max(), message.xi_max(), 1.0, "xi_max"),
          reader.required(message.has_eta_min(), message.eta_min(), 1.0, "eta_min"),
          reader.required(message.has_eta_max(), message.eta_max(), 1.0, "eta_max")};
}

simulation::ZoneSpec read_zone(const v1::Zone& message, const FieldReader& reader) {
  simulation::ZoneSpec zone;
  zone.name = message.name();
  if (message.name().empty()) reader.missing("name");
  switch (message.shape_case()) {
    case v1::Zone::kBox:
      zone.shape = read_box(message.box(), reader.below("box"));
      break;
    case v1::Zone::kDisc: {
      const FieldReader disc = reader.below("disc");
      zone.shape = simulation::Disc{
          read_skin_point(message.disc().centre(), disc.below("centre")),
          disc.required(message.disc().has_radius_mm(), message.disc().radius_mm(), kMetrePerMillimetre, "radius_mm")};
      break;
    }
    case v1::Zone::kRegion:
      zone.shape = simulation::NamedRegion{message.region()};
      break;
    case v1::Zone::SHAPE_NOT_SET:
      reader.wrong("box", "is missing, and so are disc and region: one of them says where the zone is");
  }
  return zone;
}

void read_wall(const v1::FilmWall& message, const FieldReader& reader, simulation::FilmSpec& film) {
  switch (message.kind()) {
    case v1::FilmWall::RIGID:
      film.wall = simulation::FilmWallKind::kRigid;
      break;
    case v1::FilmWall::WINKLER:
      film.wall = simulation::FilmWallKind::kWinkler;
      film.wall_stiffness = reader.required(message.has_stiffness_kpa_per_mm(), message.stiffness_kpa_per_mm(),
                                            kPascalPerMetrePerKilopascalPerMillimetre, "stiffness_kpa_per_mm");
      break;
    default:
      film.wall = simulation::FilmWallKind::kTissue;
  }
}

simulation::FilmSpec read_film(const v1::Film& message, const FieldReader& reader) {
  simulation::FilmSpec film;
  film.name = message.name();
  if (message.name().empty()) reader.missing("name");
  film.below_layer = message.below_layer();
  if (message.has_extent()) film.extent = read_box(message.extent(), reader.below("extent"));
  film.n_xi = reader.required_count(message.has_n_xi(), message.n_xi(), "n_xi");
  film.n_eta = reader.required_count(message.has_n_eta(), message.n_eta(), "n_eta");
  for (int i = 0; i < message.zones_size(); ++i) {
    film.zones.push_back(read_zone(message.zones(i), reader.below("zones", i)));
  }
  if (message.has_rest_thickness_mm()) {
    film.rest_thickness =
        read_scalar_field(message.rest_thickness_mm(), kMetrePerMillimetre, reader.below("rest_thickness_mm"));
  }
  if (message.has_initial_thickness_mm()) {
    film.initial_thickness =
        read_scalar_field(message.initial_thickness_mm(), kMetrePerMillimetre, reader.below("initial_thickness_mm"));
  }
  const bool frictionless = message.wall_friction() == v1::NONE;
  film.wall_friction = frictionless ? simulation::WallFriction::kNone : simulation::WallFriction::kNoSlip;
  read_wall(message.wall(), reader.below("wall"), film);
  return film;
}

simulation::InjectionSpec read_injection(const v1::Injection& message, const FieldReader& reader) {
  simulation::InjectionSpec injection;
  injection.zone = message.zone();
  if (message.zone().empty()) reader.missing("zone");
  injection.volume =
      reader.required(message.has_volume_ml(), message.volume_ml(), kCubicMetrePerMillilitre, "volume_ml");
  injection.rate =
      reader.required(message.has_rate_ml_per_s(), message.rate_ml_per_s(), kCubicMetrePerMillilitre, "rate_ml_per_s");
  if (message.has_start_s()) injection.start = message.start_s();
  if (message.has_site()) injection.site = read_skin_point(message.site(), reader.below("site"));
  return injection;
}

void read_time(const v1::TimeControl& message, simulation::SimulationSpec& spec) {
  if (message.has_step_ms()) spec.step = message.step_ms() * kSecondPerMillisecond;
  if (message.has_max_step_ms()) spec.max_step = message.max_step_ms() * kSecondPerMillisecond;
  if (message.has_end_s()) spec.end = message.end_s();
  if (message.has_settle_skin_speed_mm_per_s()) {
    spec.settle_skin_speed = message.settle_skin_speed_mm_per_s() * kMetrePerMillimetre;
  }
}

simulation::ProbeSpec read_probe(const v1::Probe& message, const FieldReader& reader) {
  if (message.name().empty()) reader.missing("name");
  return {message.name(), message.film(), read_skin_point(message.place(), reader.below("place"))};
}

}  // namespace

absl::StatusOr<simulation::SimulationSpec> to_simulation_spec(const v1::SimulationSpec& message) {
  FieldViolations violations;
  const FieldReader reader("", violations);
  simulation::SimulationSpec spec;
  if (message.model().empty()) reader.missing("model");
  if (message.fat().has_viscosity_pa_s()) spec.fat_viscosity = message.fat().viscosity_pa_s();
  if (message.fat().has_density_kg_m3()) spec.fat_density = message.fat().density_kg_m3();
  for (int i = 0; i < message.films_size(); ++i) {
    spec.films.push_back(read_film(message.films(i), reader.below("films", i)));
  }
  for (int i = 0; i < message.injections_size(); ++i) {
    spec.injections.push_back(read_injection(message.injections(i), reader.below("injections", i)));
  }
  read_time(message.time(), spec);
  const bool lumped = message.coupling() == v1::LUMPED;
  spec.coupling = lumped ? simulation::CouplingMode::kLumped : simulation::CouplingMode::kExact;
  if (message.has_gravity_m_s2()) spec.gravity = read_vector(message.gravity_m_s2(), 1.0, reader.below("gravity_m_s2"));
  spec.damping_mass = message.damping().mass_per_s();
  spec.damping_stiffness = message.damping().stiffness_s();
  for (int i = 0; i < message.probes_size(); ++i) {
    spec.probes.push_back(read_probe(message.probes(i), reader.below("probes", i)));
  }
  if (!violations.empty()) return violations.to_status();
  return spec;
}

absl::StatusOr<simulation::InjectionSpec> to_injection_spec(const v1::Injection& message) {
  FieldViolations violations;
  simulation::InjectionSpec spec = read_injection(message, FieldReader("", violations));
  if (!violations.empty()) return violations.to_status();
  return spec;
}

}  // namespace lipofill::server
