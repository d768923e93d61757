#include "core/planning/proposal_candidate.h"

namespace lipofill::planning {

bool is_better(const Candidate& one, const Candidate& other, double worthwhile) {
  if (one.misfit < other.misfit - worthwhile) return true;
  if (one.misfit > other.misfit + worthwhile) return false;
  if (one.n_used() != other.n_used()) return one.n_used() < other.n_used();
  return one.misfit < other.misfit;
}

}  // namespace lipofill::planning
