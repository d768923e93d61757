#pragma once

#include <string_view>

namespace lipofill::anatomy {

/// The edge tells how the tissue around a zone is attached: the stiffness per area that it reaches,
/// and the distance over which it grows, and whether fat enters it.
struct ZoneEdge {
  double stiffness = 0.0;  ///< [Pa/m]
  double width = 0.0;      ///< [m]
  bool feathers = false;   ///< fat enters it, as loose tissue lets it
};

/// The edge of a named region ("masseter_left"), and of a zone of another shape where the name is
/// none of a region. No source measures these figures: they are assumed, in the order of the
/// stiffness of skin through its thickness (90 kPa over 4 mm), firm where a region ends at septa
/// and ligaments, soft where it ends in loose fat. Checked by
/// tests/unit/anatomy/zone_edges_test.cc.
ZoneEdge edge_of_region(std::string_view name);

}  // namespace lipofill::anatomy
