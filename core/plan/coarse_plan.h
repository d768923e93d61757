#pragma once

#include <memory>

#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// The same patient on a coarser chart: nodes of every level sampled from the model's own at evenly
/// spaced places of the chart, bilinear between them, so that skin, layers and their thickness are
/// those of the model but for what the coarser grid cannot hold. Layers, supports and landmarks are
/// the model's; the scan and its riders are left out.
///
/// The chart is coarsened by 2 along both directions, and by more where that leaves more than
/// kMostPreviewHexahedra: what a preview costs does not grow with the model. No direction gets
/// fewer than kLeastPreviewDivisions, unless it has fewer. Checked by
/// tests/unit/plan/coarse_plan_test.cc.
std::shared_ptr<const model::FaceModel> coarsen_model(const model::FaceModel& model);

/// The same by 2 however many hexahedra that leaves, to compare the two results.
std::shared_ptr<const model::FaceModel> halve_model(const model::FaceModel& model);

inline constexpr double kPreviewCoarsening = 2.0;
inline constexpr int kMostPreviewHexahedra = 1200;
inline constexpr int kLeastPreviewDivisions = 8;

/// The plan for a coarser model: the settled shape in long steps (TimeGoal::kSettledShape), films
/// on cells as many of the coarse hexahedra wide as they are of the fine ones, at least 2, their
/// extents moved to lines of the coarse chart so that cells and hexahedra share their edges. Zones
/// claim cells by the centres of these; a site moves to the nearest cell of its zone, the thickness
/// of a cell at the start is the mean over it, places given by landmarks or positions are those
/// they have on the fine skin. Probes are left out. The start of every injection and all that is
/// injected stay.
/// @param spec  a plan that `fine` has taken
SimulationSpec coarsen_plan(const SimulationSpec& spec, const model::FaceModel& fine, const model::FaceModel& coarse);

}  // namespace lipofill::plan
