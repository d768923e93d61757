#include "core/anatomy/ligaments.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/anatomy/sided_names.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/geometry/skin_projection.h"

namespace lipofill::anatomy {
namespace {

constexpr double kFarthestFromSkin = 0.020;  // [m]

/// Weights of landmarks without their side.
using Weights = std::vector<std::pair<const char*, double>>;

/// A place on the mandible: its distance along the border from the midline, and its height above
/// the border [m].
struct OnMandible {
  double along = 0.0;
  double above = 0.0;
};

struct LigamentRow {
  const char* name;
  LigamentFigures figures;
  std::optional<OnMandible> on_mandible;
  Weights from;  ///< else the first point
  Weights to;    ///< and the last
  int n_points = 1;
};

const std::vector<LigamentRow>& rows() {
  static const LigamentFigures kZygomatic = {2.0e3, 20.0};
  static const LigamentFigures kMandibular = {0.5e3, 10.0};
  static const LigamentFigures kMasseteric = {0.2e3, 4.0};
  static const Weights kZygoma = {{"zygion", 0.60}, {"exocanthion", 0.15}, {"cheilion", 0.25}};
  static const Weights kMasseterTop = {{"zygion", 0.60}, {"gonion", 0.07}, {"cheilion", 0.33}};
  static const Weights kMasseterBottom = {{"zygion", 0.07}, {"gonion", 0.60}, {"cheilion", 0.33}};
  static const std::vector<LigamentRow> table = {
      {"zygomatic", kZygomatic, std::nullopt, kZygoma, kZygoma, 1},
      {"masseteric_cutaneous", kMasseteric, std::nullopt, kMasseterTop, kMasseterBottom, 5},
      {"mandibular_osteocutaneous",
       kMandibular,
       OnMandible{51.1 * kMetresPerMillimetre, 9.1 * kMetresPerMillimetre},
       {},
       {},
       1},
      {"medial_mandibular",
       kMandibular,
       OnMandible{28.5 * kMetresPerMillimetre, 8.4 * kMetresPerMillimetre},
       {},
       {},
       1},
      {"mental", kMandibular, OnMandible{9.1 * kMetresPerMillimetre, 8.4 * kMetresPerMillimetre}, {}, {}, 1},
  };
  return table;
}

/// Looks landmarks up and notes the first that is missing.
class LandmarkReader {
 public:
  LandmarkReader(const geometry::FaceGeometry& face, std::string_view side) : face_(face), side_(side) {}

  Eigen::Vector3d at(const char* landmark) {
    const std::string name = with_side(landmark, side_);
    const auto found = face_.landmarks.find(name);
    if (found != face_.landmarks.end()) return found->second;
    if (missing_.empty()) missing_ = name;
    return Eigen::Vector3d::Zero();
  }

  Eigen::Vector3d mean(const Weights& weights) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double total = 0.0;
    for (const auto& [landmark, weight] : weights) {
      sum += weight * at(landmark);
      total += weight;
    }
    return sum / total;
  }

  const std::string& missing() const { return missing_; }

 private:
  const geometry::FaceGeometry& face_;
  std::string_view side_;
  std::string missing_;
};

/// The point of the parabola of the mandible's border at an arc length from the midline, and
/// `above` it.
Eigen::Vector3d find_on_mandible(const geometry::HeadAxes& axes, const Eigen::Vector3d& menton,
                                 const Eigen::Vector3d& gonion, const OnMandible& place) {
  const Eigen::Vector3d chord = gonion - menton;
  const Eigen::Vector3d aside = chord.dot(axes.left) * axes.left;
  const Eigen::Vector3d back = chord - aside;
  const auto border = [&](double t) -> Eigen::Vector3d { return menton + t * aside + t * t * back; };
  constexpr int kSteps = 1000;
  double length = 0.0;
  Eigen::Vector3d at = menton;
  for (int k = 1; k <= kSteps && length < place.along; ++k) {
    const Eigen::Vector3d next = border(static_cast<double>(k) / kSteps);
    length += (next - at).norm();
    at = next;
  }
  return at + place.above * axes.up;
}

std::vector<Eigen::Vector3d> find_points(const geometry::FaceGeometry& face, const LigamentRow& row,
                                         LandmarkReader& landmarks) {
  if (row.on_mandible) {
    const Eigen::Vector3d menton = landmarks.at("menton");
    return {find_on_mandible(face.axes, menton, landmarks.at("gonion"), *row.on_mandible)};
  }
  const Eigen::Vector3d from = landmarks.mean(row.from);
  const Eigen::Vector3d to = landmarks.mean(row.to);
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < row.n_points; ++k) {
    const double t = row.n_points == 1 ? 0.0 : static_cast<double>(k) / (row.n_points - 1);
    points.emplace_back((1.0 - t) * from + t * to);
  }
  return points;
}

absl::StatusOr<PlacedLigament> place_row(const geometry::FaceGeometry& face, const LigamentRow& row,
                                         std::string_view name, std::string_view side) {
  LandmarkReader landmarks(face, side);
  const std::vector<Eigen::Vector3d> points = find_points(face, row, landmarks);
  if (!landmarks.missing().empty()) {
    return field_violation(
        "", absl::StrCat("is '", std::string(name), "', which needs the landmark ", landmarks.missing()));
  }
  PlacedLigament placed;
  placed.figures = row.figures;
  const geometry::SkinProjection projection(face.grid);
  for (const Eigen::Vector3d& point : points) {
    const geometry::SkinFoot foot = projection.project(point);
    const bool inside = std::max(std::abs(foot.place.xi - 0.5), std::abs(foot.place.eta - 0.5)) <= 0.5;
    if (inside && foot.distance <= kFarthestFromSkin) {
      placed.points.push_back(foot.place);
    } else {
      ++placed.points_outside;
    }
  }
  if (!placed.points.empty()) return placed;
  return field_violation("", absl::StrCat("is '", std::string(name), "', which lies outside the charted region"));
}

}  // namespace

std::vector<std::string> ligament_names() {
  std::vector<std::string> names;
  for (const LigamentRow& row : rows()) names.emplace_back(row.name);
  return names;
}

absl::StatusOr<PlacedLigament> place_ligament(const geometry::FaceGeometry& face, std::string_view name) {
  if (const auto parts = split_side(name)) {
    for (const LigamentRow& row : rows()) {
      if (parts->first == row.name) return place_row(face, row, name, parts->second);
    }
  }
  return field_violation("", absl::StrCat("is '", std::string(name), "', must be one of ",
                                          absl::StrJoin(ligament_names(), ", "), " followed by _left or _right"));
}

}  // namespace lipofill::anatomy
