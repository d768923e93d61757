#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry/chart_box.h"
#include "core/geometry/face_geometry.h"

namespace lipofill::simulation {

enum class CouplingMode { kExact, kLumped };
enum class WallFriction { kNoSlip, kNone };
enum class FilmWallKind { kTissue, kRigid, kWinkler };

using geometry::ChartBox;

struct Disc {
  geometry::SkinPoint centre;
  double radius = 0.0;  ///< [m] straight distance from the centre
};

struct NamedRegion {
  std::string name;
};

struct ZoneSpec {
  std::string name;
  std::variant<ChartBox, Disc, NamedRegion> shape;
};

struct FilmSpec {
  std::string name;
  std::string below_layer;
  ChartBox extent;
  int n_xi = 0;
  int n_eta = 0;
  std::vector<ZoneSpec> zones;
  geometry::ScalarField rest_thickness = geometry::ScalarField::constant(0.05e-3);  ///< [m]
  std::optional<geometry::ScalarField> initial_thickness;                           ///< [m]
  WallFriction wall_friction = WallFriction::kNoSlip;
  FilmWallKind wall = FilmWallKind::kTissue;
  double wall_stiffness = 0.0;  ///< [Pa/m], kWinkler only
};

struct InjectionSpec {
  std::string zone;
  double volume = 0.0;          ///< [m3], negative: taken out
  double rate = 0.0;            ///< [m3/s] > 0
  std::optional<double> start;  ///< [s]
  std::optional<geometry::SkinPoint> site;
};

struct ProbeSpec {
  std::string name;
  std::string film;
  geometry::SkinPoint place;
};

/// All that a simulation is made from besides its model; lipofill.v1.SimulationSpec in SI.
struct SimulationSpec {
  double fat_viscosity = 15.0;  ///< [Pa s]
  double fat_density = 920.0;   ///< [kg/m3]
  std::vector<FilmSpec> films;
  std::vector<InjectionSpec> injections;
  double step = 0.010;                 ///< [s]
  std::optional<double> max_step;      ///< [s]
  double end = 60.0;                   ///< [s]
  double settle_skin_speed = 0.02e-3;  ///< [m/s], 0: never
  CouplingMode coupling = CouplingMode::kExact;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< [m/s2]
  double damping_mass = 0.0;                          ///< alpha [1/s]
  double damping_stiffness = 0.0;                     ///< beta [s]
  std::vector<ProbeSpec> probes;
};

}  // namespace lipofill::simulation
