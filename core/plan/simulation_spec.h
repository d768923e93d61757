#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/film/rheology.h"
#include "core/geometry/chart_box.h"
#include "core/geometry/face_geometry.h"

namespace lipofill::plan {

enum class CouplingMode { kExact, kLumped };
/// The purpose of a simulation: to be watched, or to find the final shape in as few steps as
/// possible.
enum class TimeGoal { kTransient, kSettledShape };
enum class FilmWallKind { kTissue, kRigid, kWinkler };

using geometry::ChartBox;

struct Disc {
  geometry::SkinPoint centre;
  double radius = 0.0;  ///< [m] straight distance from the centre
};

struct NamedRegion {
  std::string name;
};

/// The region in which a field over the chart, 1 inside and 0 outside, is at least a half.
struct PaintedRegion {
  geometry::ScalarField cover;
};

struct ZoneSpec {
  std::string name;
  std::variant<ChartBox, Disc, NamedRegion, PaintedRegion> shape;
};

/// A wall of a film: a line through its zones, or where two of its zones touch.
struct WallSpec {
  std::string name;
  std::vector<geometry::SkinPoint> path;  ///< has at least two points; `between` counts where it is empty
  std::array<std::string, 2> between;     ///< names of two zones
  double leakage = 0.0;                   ///< flux per length and pressure difference [m2/(Pa s)]; 0: tight
};

/// Fibres that hold the walls of a film together.
struct ConnectiveTissueSpec {
  double stiffness = 0.0;       ///< the fibres have it per area [Pa/m]; 0: there are none
  double entry_pressure = 0.0;  ///< fat beside the cell enters it above this pressure [Pa]; 0: it is open
};

/// This says how the outlines of a film's zones become cells.
enum class ZoneOutline {
  kCurve,  ///< as drawn: the outline cuts the cells it crosses
  kCells,  ///< as the paper has it: the cells whose centres lie inside, whole
};

/// Tissue that attaches the walls of a film to one another around its zones. Its stiffness per area
/// grows linearly from 0 on the outline to `stiffness` at a distance of `width`, beyond which the
/// layers are bonded. Where two zones touch, a septum of the same width and stiffness stands on
/// their border.
struct AttachmentSpec {
  double stiffness = 0.0;  ///< [Pa/m]
  double width = 0.0;      ///< [m]
  bool feathers = false;   ///< fat goes on through it; otherwise it ends at the outline
};

/// The edge of a film's zones.
struct ZoneEdgeSpec {
  ZoneOutline outline = ZoneOutline::kCurve;
  bool is_rigid = false;                     ///< bonded from the outline on, as the paper has it
  std::optional<AttachmentSpec> attachment;  ///< none: bonded on a square, by region on a face (anatomy/zone_edges.h)
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
  film::WallFriction wall_friction = film::WallFriction::kNoSlip;
  FilmWallKind wall = FilmWallKind::kTissue;
  double wall_stiffness = 0.0;  ///< [Pa/m], kWinkler only
  std::vector<WallSpec> walls;
  ConnectiveTissueSpec connective_tissue;
  ZoneEdgeSpec edge;
};

struct NamedLigament {
  std::string name;
};

/// Springs between the outer wall of one film and the inner wall of another, or of the same.
struct LigamentSpec {
  std::string name;
  std::string film;        ///< the outermost film it crosses; empty: the first on tissue
  std::string inner_film;  ///< the innermost; empty: the same
  std::variant<std::vector<geometry::SkinPoint>, NamedLigament> place;
  std::optional<double> stiffness;       ///< each point has it [N/m]; a named ligament has its own
  double slack = 0.0;                    ///< [m]
  std::optional<double> breaking_force;  ///< each point breaks at it [N]; without one it holds
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
  double fat_viscosity = 15.0;              ///< [Pa s]
  double fat_density = 920.0;               ///< [kg/m3]
  double fat_flow_index = 1.0;              ///< n; then fat_viscosity is the consistency [Pa s^n]
  double fat_yield_stress = 0.0;            ///< [Pa]
  std::optional<double> fat_shear_modulus;  ///< the fat is a Maxwell element with it [Pa]
  std::optional<double> suction_limit;      ///< a void opens in the film below minus this pressure [Pa]
  std::vector<FilmSpec> films;
  std::vector<InjectionSpec> injections;
  TimeGoal goal = TimeGoal::kTransient;
  double step = 0.010;                       ///< [s]
  std::optional<double> max_step;            ///< after the last injection [s]; none: `step`
  std::optional<double> max_injection_step;  ///< until then [s]; none: `step`
  double end = 60.0;                         ///< [s]
  double settle_skin_speed = 0.02e-3;        ///< [m/s], 0: never
  CouplingMode coupling = CouplingMode::kExact;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< [m/s2]
  double damping_mass = 0.0;                          ///< alpha [1/s]
  double damping_stiffness = 0.0;                     ///< beta [s]
  std::vector<ProbeSpec> probes;
  std::vector<LigamentSpec> ligaments;
  double error_tolerance = 0.02e-3;  ///< bounds skin and thickness in a step longer than `step` [m]
};

}  // namespace lipofill::plan
