#pragma once

#include <memory>

#include "core/planning/proposal_fit.h"
#include "core/planning/proposal_zones.h"
#include "core/planning/zones_from_deficit.h"

namespace lipofill::planning {

/// A choice of zones with its best volumes.
struct Candidate {
  ZoneLayout layout;
  std::unique_ptr<VolumeFit> fit;
  FittedVolumes fitted;
  double misfit = 0.0;  ///< of all skin, as if it were an rms of that which lacks something [m]

  size_t n_used() const { return static_cast<size_t>((fitted.volumes.array() > 0.0).count()); }
};

/// True where one is nearer by what is worthwhile [m], or as near with fewer zones or less.
/// Checked by tests/unit/planning/proposal_test.cc.
bool is_better(const Candidate& one, const Candidate& other, double worthwhile);

}  // namespace lipofill::planning
