#include "core/solid/node_blocks.h"

#include "core/base/lanes.h"

namespace lipofill::solid {
namespace {

constexpr unsigned kAllFree = 7;

/// The terms of one column of a block: the value written is factor K + geometric, where geometric
/// is K_G at its own component.
struct BlockColumn {
  const double* k;
  Lanes geometric;
};

/// Three values at once; the fourth that is written along is overwritten by the next, since places
/// ascend and the last column of all has one value only.
LIPOFILL_INLINE int write_whole(const BlockColumn& column, double factor, double* stiffness, double* system) {
  const Lanes k = load(column.k);
  store(k, stiffness);
  store(multiply_add(fill_lanes(factor), k, column.geometric), system);
  return 3;
}

int write_free(const BlockColumn& column, unsigned components, double factor, double* stiffness, double* system) {
  int n = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(components >> i & 1)) continue;
    stiffness[n] = column.k[i];
    system[n++] = multiply_add(factor, column.k[i], column.geometric[i]);
  }
  return n;
}

}  // namespace

void NodeBlocks::write(const SystemPattern& pattern, const Eigen::VectorXd& constant_geometric, double factor,
                       double* stiffness, double* system) const {
  const std::vector<int>& rows = pattern.block_rows();
  const Lanes unit[3] = {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}};
  for (int b = 0; b < pattern.n_nodes(); ++b) {
    const int first = pattern.block_starts()[b];
    const int last = pattern.block_starts()[b + 1];
    for (int j = 0; j < 3; ++j) {
      if (!(pattern.free_components(b) >> j & 1)) continue;
      for (int block = first; block < last; ++block) {
        const double* const values = values_.data() + 12 * static_cast<ptrdiff_t>(block);
        const double constant = constant_geometric.size() > 0 ? constant_geometric.data()[block] : 0.0;
        const BlockColumn column{values + 4 * j, fill_lanes(values[3] + constant) * unit[j]};
        const unsigned lower = block == first ? kAllFree << j : kAllFree;
        const unsigned components = pattern.free_components(rows[block]) & lower;
        const int n = components == kAllFree ? write_whole(column, factor, stiffness, system)
                                             : write_free(column, components, factor, stiffness, system);
        stiffness += n;
        system += n;
      }
    }
  }
}

}  // namespace lipofill::solid
