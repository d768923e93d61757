#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/face_geometry.h"

namespace lipofill::anatomy {

/// Names that place_ligament knows, without their side: "zygomatic", "masseteric_cutaneous",
/// "mandibular_osteocutaneous", "medial_mandibular", "mental".
std::vector<std::string> ligament_names();

/// Stiffness and strength of one point of a ligament.
///
/// | ligament                                           | stiffness N/mm | breaking force N |
/// |----------------------------------------------------|----------------|------------------|
/// | zygomatic                                          | 2.0            | 20               |
/// | mandibular_osteocutaneous, medial_mandibular, mental | 0.5          | 10               |
/// | masseteric_cutaneous, each of its five points      | 0.2            | 4                |
///
/// Only the order has a source: stiffness zygomatic > orbital > maxillary > mandibular, strength
/// zygomatic > orbital > mandibular > maxillary (Brandt 2012). No absolute figure in N/mm was
/// found: all of them, and the place of the masseteric cutaneous fibres below the others, are
/// assumed, to be overridden and swept.
struct LigamentFigures {
  double stiffness = 0.0;       ///< [N/m]
  double breaking_force = 0.0;  ///< [N]
};

/// A ligament brought to a face.
struct PlacedLigament {
  std::vector<geometry::ChartPoint> points;  ///< those of its points that lie in the charted region, at least one
  int points_outside = 0;                    ///< those that do not
  LigamentFigures figures;                   ///< every point has these
};

/// Returns the place where the named ligament ("zygomatic_left") reaches the skin.
///
/// - mental, medial_mandibular, mandibular_osteocutaneous: 9.1 / 8.4, 28.5 / 8.4 and 51.1 / 9.1 mm
///   lateral of the midline / above the inferior border of the mandible (pubmed 27427339). Lateral
///   distances are taken along the border (assumed: straight to the side, 51 mm is the angle of the
///   jaw), which runs from menton (t = 0) to gonion (t = 1) as the parabola
///
///       x(t) = menton + t a left + t^2 (b forward + c up),   gonion = x(1).
///
/// - zygomatic: under the inferior border of the zygoma behind the origin of the zygomaticus minor
///   (Furnas 1989), as a weighted mean of zygion, exocanthion and cheilion (assumed).
/// - masseteric_cutaneous: five points evenly spaced along the anterior border of the masseter,
///   which runs at a third
/// of
///   the way from the line zygion - gonion to cheilion (assumed).
///
/// Points are projected onto the skin of the chart from at most 20 mm. INVALID_ARGUMENT with the
/// field violation "" for an unknown name (listing the known), a landmark that is not there, and a
/// ligament none of whose points is in the charted region. Checked by
/// tests/unit/anatomy/ligaments_test.cc.
absl::StatusOr<PlacedLigament> place_ligament(const geometry::FaceGeometry& face, std::string_view name);

}  // namespace lipofill::anatomy
