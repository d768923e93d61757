#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/base/lanes.h"
#include "core/solid/element_assembler.h"
#include "core/solid/element_batch.h"

namespace lipofill::solid {

// This is what the assemblers of all laws have in common: which hexahedra may share a batch, and
// the sums over batches.

/// For each pair of nodes in binary order, true when the first comes before the second in the mesh.
using NodeOrder = std::array<bool, kNodePairs>;

/// Calls visit(a, b, pair) for all pairs a >= b of nodes in binary order.
template <class Visit>
void for_each_node_pair(const Visit& visit) {
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b <= a; ++b) visit(a, b, node_pair(a, b));
  }
}

inline NodeOrder find_node_order(const std::array<int, 8>& hexahedron) {
  NodeOrder before{};
  for_each_node_pair(
      [&](int a, int b, int pair) { before[pair] = hexahedron[kCornerOfBinary[a]] < hexahedron[kCornerOfBinary[b]]; });
  return before;
}

/// Sums of batches, lane by lane.
struct TotalsOfLanes {
  Lanes energy{};
  Lanes least_ratio = fill_lanes(std::numeric_limits<double>::infinity());
  LaneMask is_folded{};

  LIPOFILL_INLINE void add(const Lanes& of_batch, const Lanes& volume_ratio, const Lanes& least_corner) {
    energy += of_batch;
    const LaneMask is_finite = volume_ratio - volume_ratio == 0.0;
    const Lanes ratio = is_finite ? volume_ratio : fill_lanes(-std::numeric_limits<double>::infinity());
    least_ratio = ratio < least_ratio ? ratio : least_ratio;
    is_folded |= ~((least_corner > 0.0) & (ratio > 0.0));
  }

  ElementTotals sum() const {
    ElementTotals totals{0.0, std::numeric_limits<double>::infinity(), any(is_folded)};
    for (int lane = 0; lane < kLanes; ++lane) {
      totals.elastic_energy += energy[lane];
      totals.min_volume_ratio = std::min(totals.min_volume_ratio, least_ratio[lane]);
    }
    return totals;
  }
};

/// Lists the hexahedra of a batch (-1: left over) with a corner below the limit of the barrier.
LIPOFILL_INLINE void list_squeezed(const Lanes& least_corner, const Lanes& limit,
                                   const std::array<int, kLanes>& hexahedra, std::vector<int>& squeezed) {
  const LaneMask is_squeezed = ~(least_corner >= limit);
  for (int lane = 0; any(is_squeezed) && lane < kLanes; ++lane) {
    if (is_squeezed[lane] != 0 && hexahedra[lane] >= 0) squeezed.push_back(hexahedra[lane]);
  }
}

}  // namespace lipofill::solid
