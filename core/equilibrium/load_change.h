#pragma once

#include <optional>

#include "core/equilibrium/parts.h"
#include "core/equilibrium/tangent.h"

namespace lipofill::equilibrium {

/// A load change is what a unit of a parameter asks of a shape in balance (tangent.h). The balance
/// is at the shape before and after. Checked by tests/unit/equilibrium/equilibrium_test.cc against
/// differences of converged shapes.

/// True where tissues have the same free nodes and cells.
bool have_same_unknowns(const Parts& a, const Parts& b);

/// Factors at a shape, where the balance is then. There is no factor where the tissue is not
/// positive definite.
void factor_at(Parts& parts, const Found& found);
/// Brings a shape closer to balance where that can be: what a modulus or a thickness does is small
/// beside the shape. The balance is there.
void refine(Parts& parts, Found& found);

/// Gives the change by a pool's volume [1/m3].
LoadChange change_by_volume(const Found& found, int pool);
/// Gives the change by ln E of a layer; nothing where the modulus is at both of its bounds.
std::optional<LoadChange> change_by_modulus(Parts& parts, const Found& found, int layer);
/// Gives the change by whatever makes the tissue of `beside` from this one, with the same nodes,
/// cells and injections, by `step` units of it; nothing where those are not the same.
std::optional<LoadChange> change_towards(Parts& parts, const Found& found, Parts& beside, double step);

}  // namespace lipofill::equilibrium
