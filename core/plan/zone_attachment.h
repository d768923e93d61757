#pragma once

#include <vector>

#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// The attachment around a zone of a plan that gives none (anatomy/zone_edges.h).
AttachmentSpec assume_attachment(const ZoneSpec& zone);

/// True where the layers are bonded from the outline on.
bool has_rigid_edge(const model::FaceModel& model, const ZoneEdgeSpec& edge);

/// Finds how far beyond the outline of each zone of a film its fat may go [m]: the width of an
/// attachment into which it feathers, 0 around any other edge. Checked by
/// tests/unit/plan/zone_feather_test.cc.
std::vector<double> find_feather_widths(const model::FaceModel& model, const FilmSpec& spec);

}  // namespace lipofill::plan
