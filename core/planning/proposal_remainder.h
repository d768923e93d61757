#pragma once

#include <string>
#include <vector>

#include "core/planning/proposal_case.h"
#include "core/planning/proposal_fit.h"

namespace lipofill::planning {

/// Why skin stays away from its target: a bound holds the volume; no zone lies under it; the tissue
/// spreads the lift of a zone wider than the target wants it; it lies outside its target already.
enum class Cause { kBound, kOutOfReach, kStiffness, kAboveTarget };

/// A remainder is what a proposal leaves under one zone, or beside all of them, for one cause.
struct Remainder {
  std::string zone;  ///< the one that moves this skin most; empty: none does
  Cause cause = Cause::kStiffness;
  Bound bound = Bound::kNone;      ///< kBound only
  geometry::VolumeBetween volume;  ///< areas times distances [m3]
  double rms = 0.0;                ///< [m]
};

/// Tells what is left of the skin that lacked something, and of skin that was outside its target or
/// has been lifted past it, from the most volume to the least; parts of less than 0.02 mL are left
/// out. Checked by tests/unit/planning/proposal_test.cc.
std::vector<Remainder> explain_remainders(const ProposalCase& face, const std::vector<SoughtZone>& zones,
                                          const FittedVolumes& fitted);

/// Tells which share of what is missing lies under skin that the zones can move.
double share_within_reach(const ProposalCase& face, const FittedVolumes& fitted);

/// One sentence, with its figures.
std::string describe_remainder(const Remainder& remainder);

/// A sentence for skin that stays so far from its target that the target is in doubt [m]; empty
/// within 2 mm (assumed: a face that is filled towards its own target stays within 1 mm).
std::string describe_doubt(double before, double reached);

/// The misfit without a zone where all is linear, the other volumes at their best: the sum of
/// squares grows by V^2 / (N^-1)_zz, N: the normal matrix.
/// @param misfit  of all skin with it, as if it were an rms of that which lacks something [m]
double foresee_without(const ProposalCase& face, const FittedVolumes& fitted, double misfit, Eigen::Index zone);

}  // namespace lipofill::planning
