#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry/surface_locator.h"
#include "core/planning/nearest_grid.h"
#include "core/planning/skin_surface.h"
#include "core/planning/surface_samples.h"

namespace lipofill::planning {

/// The place on a skin that a point belongs to.
struct SkinMatch {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< unit
  double distance = 0.0;                               ///< of the point from the skin there [m], not negative
};

/// Finds what belongs together on two surfaces.
class SkinMatcher {
 public:
  virtual ~SkinMatcher() = default;
  /// The place for a point within `reach` [m] whose normal looks less than 53 degrees away; nothing
  /// where there is none, or where it is the border of the skin: the point then lies beyond it.
  virtual std::optional<SkinMatch> match(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                         double reach) const = 0;

 protected:
  static constexpr double kLeastAgreement = 0.6;  ///< of two normals, their cosine
};

/// Looks the nearest sample up and takes its tangent plane: fast, good to some tenths of a
/// millimetre.
class GridMatcher : public SkinMatcher {
 public:
  GridMatcher(const SurfaceSamples& samples, double cell) : samples_(samples), grid_(samples, cell, kMargin) {}
  std::optional<SkinMatch> match(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                 double reach) const override;
  const SurfaceSamples& samples() const { return samples_; }

 private:
  static constexpr double kMargin = 0.03;  // [m]
  SurfaceSamples samples_;
  NearestGrid grid_;
};

/// Finds the nearest point of the triangles. Checked by tests/unit/planning/alignment_test.cc.
class ExactMatcher : public SkinMatcher {
 public:
  explicit ExactMatcher(const SkinSurface& skin) : skin_(skin), locator_(skin.mesh) {}
  std::optional<SkinMatch> match(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                 double reach) const override;

 private:
  const SkinSurface& skin_;
  geometry::SurfaceLocator locator_;
};

}  // namespace lipofill::planning
