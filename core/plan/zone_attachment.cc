#include "core/plan/zone_attachment.h"

#include <variant>

#include "core/anatomy/zone_edges.h"

namespace lipofill::plan {

AttachmentSpec assume_attachment(const ZoneSpec& zone) {
  const auto* region = std::get_if<NamedRegion>(&zone.shape);
  const anatomy::ZoneEdge edge = anatomy::edge_of_region(region != nullptr ? region->name : "");
  return {edge.stiffness, edge.width, edge.feathers};
}

bool has_rigid_edge(const model::FaceModel& model, const ZoneEdgeSpec& edge) {
  return edge.is_rigid || (!edge.attachment.has_value() && model.is_square);
}

std::vector<double> find_feather_widths(const model::FaceModel& model, const FilmSpec& spec) {
  std::vector<double> widths(spec.zones.size(), 0.0);
  if (spec.wall != FilmWallKind::kTissue || has_rigid_edge(model, spec.edge)) return widths;
  for (size_t z = 0; z < spec.zones.size(); ++z) {
    const AttachmentSpec attachment = spec.edge.attachment.value_or(assume_attachment(spec.zones[z]));
    if (attachment.feathers) widths[z] = attachment.width;
  }
  return widths;
}

}  // namespace lipofill::plan
