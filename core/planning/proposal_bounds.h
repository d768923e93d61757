#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::planning {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Bounds of the volume of a zone [m3].
struct VolumeRange {
  double low = 0.0;
  double high = kUnbounded;
};

/// The bounds are what volumes must keep to.
struct ProposalBounds {
  VolumeRange each_zone;                     ///< of zones that have no own
  std::map<std::string, VolumeRange> zones;  ///< by name
  double max_total = kUnbounded;             ///< [m3]
  double max_pressure = kUnbounded;          ///< of the fat at rest, the mean over each zone [Pa]
  double max_lift = kUnbounded;              ///< of any node of the skin [m]

  const VolumeRange& of(const std::string& zone) const {
    const auto own = zones.find(zone);
    return own == zones.end() ? each_zone : own->second;
  }
};

/// This tells whether the zones of a plan are those of its proposal, or some of them and others.
enum class ZoneNumber { kFixed, kSought };

/// Checks that some volumes keep to the bounds. INVALID_ARGUMENT with violations of
/// "bounds.zone_bounds[name]", also for a name that no zone of the plan has, "bounds.max_zone_ml"
/// and "bounds.max_total_ml". Checked by tests/unit/planning/proposal_bounds_test.cc.
absl::Status check_bounds(const ProposalBounds& bounds, const plan::SimulationSpec& plan, ZoneNumber number);

/// This names what holds a volume; kPath: no more of the fat goes in.
enum class Bound { kNone, kMinZone, kMaxZone, kMaxTotal, kMaxPressure, kMaxLift, kPath };

/// The cost is what solving took.
struct ProposalCost {
  int shapes = 0;       ///< settled shapes
  int derivatives = 0;  ///< of a shape by a volume
  int factorisations = 0;

  int solves() const { return shapes + derivatives; }
  void add(const ProposalCost& other) {
    shapes += other.shapes;
    derivatives += other.derivatives;
    factorisations += other.factorisations;
  }
};

}  // namespace lipofill::planning
