#include "client/cpp/volume/nifti_geometry.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

/// Rows and columns of a map of space: the last column is where voxel (0, 0, 0) is.
using Map = Eigen::Matrix<double, 3, 4>;

/// Sizes of a voxel, without their sign; 1 for what is 0 or no number.
Eigen::Vector3d voxel_sizes(const NiftiFields& fields, VolumeHeader* header) {
  Eigen::Vector3d sizes;
  for (int a = 0; a < 3; ++a) {
    const double pixdim = fields.pixdim[static_cast<size_t>(a + 1)];
    const bool usable = std::isfinite(pixdim) && pixdim != 0.0;
    sizes[a] = usable ? std::abs(pixdim) : 1.0;
    if (!usable || pixdim < 0.0)
      header->remarks.push_back(absl::StrCat("pixdim[", a + 1, "] is ", pixdim, ": ", sizes[a], " is taken"));
  }
  return sizes;
}

Map by_sform(const NiftiFields& fields) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(fields.srow.data());
}

Map by_qform(const NiftiFields& fields, VolumeHeader* header) {
  const Eigen::Vector3d bcd(fields.quaternion[0], fields.quaternion[1], fields.quaternion[2]);
  // A unit quaternion whose real part is left out, as it is not negative.
  Eigen::Quaterniond rotation(std::sqrt(std::max(0.0, 1.0 - bcd.squaredNorm())), bcd[0], bcd[1], bcd[2]);
  rotation.normalize();
  Eigen::Vector3d sizes = voxel_sizes(fields, header);
  if (fields.pixdim[0] < 0.0) sizes[2] = -sizes[2];
  Map map;
  map.leftCols<3>() = rotation.toRotationMatrix() * sizes.asDiagonal();
  map.col(3) << fields.qoffset[0], fields.qoffset[1], fields.qoffset[2];
  return map;
}

Map by_spacing(const NiftiFields& fields, VolumeHeader* header) {
  Map map = Map::Zero();
  map.leftCols<3>() = voxel_sizes(fields, header).asDiagonal();
  return map;
}

bool spans_space(const Map& map) {
  const double scale = map.leftCols<3>().norm();
  return map.allFinite() && scale > 0.0 && std::abs(map.leftCols<3>().determinant()) > 1e-12 * scale * scale * scale;
}

/// Millimetres in the unit of space (nifti1.h: NIFTI_UNITS_METER, _MM, _MICRON).
double millimetres_in(int64_t units, VolumeHeader* header) {
  switch (units & 7) {
    case 1:
      return 1000.0;
    case 3:
      return 1e-3;
    case 0:
    case 2:
      return 1.0;
    default:
      header->remarks.push_back(absl::StrCat("xyzt_units ", units, " is not known: millimetres are assumed"));
      return 1.0;
  }
}

}  // namespace

absl::Status set_nifti_geometry(const std::filesystem::path& file, const NiftiFields& fields, VolumeHeader* header) {
  const bool has_sform = fields.sform_code > 0 && spans_space(by_sform(fields));
  const bool has_qform = fields.qform_code > 0;
  if (fields.sform_code > 0 && !has_sform) {
    header->remarks.push_back(absl::StrCat(
        "the sform does not span space: ", has_qform ? "the qform" : "the voxel size", " is taken in its place"));
  }
  Map map = has_sform ? by_sform(fields) : has_qform ? by_qform(fields, header) : by_spacing(fields, header);
  if (!map.allFinite()) return bad_volume(file, "has a qform with numbers that are not finite");
  map *= millimetres_in(fields.units, header);
  const bool oriented = has_sform || has_qform;
  if (oriented) map.topRows<2>() *= -1.0;
  header->frame = oriented ? "LPS" : "the file's own";
  header->index_to_mm = {};
  header->index_to_mm[15] = 1.0;
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(header->index_to_mm.data()) = map;
  return absl::OkStatus();
}

void set_nifti_scaling(const NiftiFields& fields, VolumeHeader* header) {
  if (!std::isfinite(fields.slope) || fields.slope == 0.0) return;
  header->slope = fields.slope;
  header->intercept = fields.intercept;
  if (std::isfinite(fields.intercept)) return;
  header->intercept = 0.0;
  header->remarks.push_back(absl::StrCat("scl_inter is ", fields.intercept, ": 0 is taken"));
}

}  // namespace lipofill::client
