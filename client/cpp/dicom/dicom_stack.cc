#include "client/cpp/dicom/dicom_stack.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lipofill::client {
namespace {

using Eigen::Vector3d;

/// Positions are decimal strings, often of two digits behind the point.
constexpr double kSamePlaceMm = 1e-3;
constexpr double kEvenPart = 0.01;
constexpr double kEvenMm = 0.02;
/// A gap this many times those beside it has lost a slice.
constexpr double kGapFactor = 1.5;
constexpr double kLeastTiltDeg = 0.1;

absl::Status refuse(std::string what) {
  return absl::InvalidArgumentError(std::move(what));
}

Vector3d position_of(const DicomFrame& frame) {
  return Eigen::Map<const Vector3d>(frame.position.data());
}

Vector3d normal_of(const DicomFrame& frame) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 2>> axes(frame.orientation.data());
  return axes.col(0).cross(axes.col(1)).normalized();
}

std::string name_of_orientation(const DicomFrame& frame) {
  const Vector3d normal = normal_of(frame).cwiseAbs();
  constexpr double kNearAxis = 0.8;
  if (normal.z() > kNearAxis) return "axial";
  if (normal.y() > kNearAxis) return "coronal";
  return normal.x() > kNearAxis ? "sagittal" : "oblique";
}

/// Leaves out localizers, unless there is nothing else, and copies of the same image.
void leave_out(std::vector<DicomFrame>* images, std::vector<std::string>* remarks) {
  const auto is_localizer = [](const DicomFrame& frame) { return frame.is_localizer; };
  const auto localizers = std::count_if(images->begin(), images->end(), is_localizer);
  if (localizers > 0 && localizers < static_cast<std::ptrdiff_t>(images->size())) {
    std::erase_if(*images, is_localizer);
    remarks->push_back(absl::StrCat(localizers, " images are localizers and were left out"));
  }
  std::set<std::pair<std::string, uint32_t>> seen;
  const auto copies = std::erase_if(*images, [&](const DicomFrame& frame) {
    return !frame.image_uid.empty() && !seen.emplace(frame.image_uid, frame.number).second;
  });
  if (copies > 0) remarks->push_back(absl::StrCat(copies, " images are there twice and were taken once"));
}

/// The first image that cannot be read speaks for all that cannot.
absl::Status check_each(const std::vector<DicomFrame>& images) {
  const auto has_problem = [](const DicomFrame& frame) { return !frame.problem.empty(); };
  const auto first = std::find_if(images.begin(), images.end(), has_problem);
  if (first == images.end()) return absl::OkStatus();
  const auto count = std::count_if(images.begin(), images.end(), has_problem);
  return refuse(absl::StrCat(count, " of its ", images.size(), " images cannot be used: the first, ",
                             first->file.filename().string(), ", ", first->problem));
}

/// Says which of the images is unlike the first, and in what.
absl::Status check_alike(const std::vector<DicomFrame>& images) {
  const DicomFrame& first = images.front();
  for (const DicomFrame& image : images) {
    if (image.patient != first.patient)
      return refuse("its images are of more than one patient: export the series of one patient alone");
    if (image.rows != first.rows || image.columns != first.columns) {
      return refuse(
          absl::StrFormat("its images have different sizes, %d x %d and %d x %d pixels: export those of one "
                          "size alone",
                          first.columns, first.rows, image.columns, image.rows));
    }
    double turned = 0.0;
    for (size_t k = 0; k < 6; ++k) turned = std::max(turned, std::abs(image.orientation[k] - first.orientation[k]));
    if (turned > 1e-2) {
      const auto count = std::count_if(images.begin(), images.end(), [&](const DicomFrame& other) {
        return name_of_orientation(other) == name_of_orientation(image);
      });
      return refuse(absl::StrFormat(
          "its images have mixed orientations, %s and %s (%d of %d are %s): export those of "
          "one orientation alone",
          name_of_orientation(first), name_of_orientation(image), count, images.size(), name_of_orientation(image)));
    }
    for (size_t k = 0; k < 2; ++k) {
      if (std::abs(image.spacing[k] / first.spacing[k] - 1.0) > kEvenPart)
        return refuse(
            absl::StrFormat("its images have different pixel spacings, %g and %g mm: export those of one alone",
                            first.spacing[k], image.spacing[k]));
    }
  }
  return absl::OkStatus();
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

absl::Status check_places(const std::vector<double>& at, const std::vector<double>& gaps) {
  for (size_t k = 0; k < gaps.size(); ++k) {
    if (gaps[k] >= kSamePlaceMm) continue;
    return refuse(
        absl::StrFormat("two of its images lie at the same place, %.2f mm along the slices: export one phase "
                        "or reconstruction alone",
                        at[k]));
  }
  return absl::OkStatus();
}

/// Looks for a gap much wider than those beside it.
absl::Status check_gaps(const std::vector<double>& at, const std::vector<double>& gaps, bool bridge,
                        std::vector<std::string>* remarks) {
  for (size_t k = 0; k < gaps.size(); ++k) {
    double beside = 0.0;
    if (k > 0) beside = gaps[k - 1];
    if (k + 1 < gaps.size()) beside = std::max(beside, gaps[k + 1]);
    if (beside == 0.0 || gaps[k] <= kGapFactor * beside) continue;
    const long missing = std::max(1L, std::lround(gaps[k] / beside) - 1);
    const std::string what = absl::StrFormat(
        "slices are missing: %.2f mm lie between the slices at %.2f and %.2f mm, %.2f mm between those beside them "
        "(about %d of %d missing)",
        gaps[k], at[k], at[k + 1], beside, missing, gaps.size() + 1 + static_cast<size_t>(missing));
    if (!bridge)
      return refuse(what + ": export the series again, or cross the gap in a straight line with --bridge-gaps");
    remarks->push_back(what + "; the gap is crossed in a straight line");
  }
  return absl::OkStatus();
}

/// Sets the map of voxels, with the places of slices that the map does not say well enough.
void set_map(DicomStack* stack, double smallest_gap, double widest_gap) {
  const DicomFrame& first = stack->slices.front();
  const auto steps = static_cast<double>(stack->slices.size() - 1);
  const Vector3d origin = position_of(first);
  const Vector3d step = (position_of(stack->slices.back()) - origin) / steps;
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> map(stack->index_to_mm.data());
  const Eigen::Map<const Eigen::Matrix<double, 3, 2>> axes(first.orientation.data());
  map.setIdentity();
  map.block<3, 1>(0, 0) = axes.col(0) * first.spacing[0];
  map.block<3, 1>(0, 1) = axes.col(1) * first.spacing[1];
  map.block<3, 1>(0, 2) = step;
  map.block<3, 1>(0, 3) = origin;
  double off = 0.0;
  for (size_t k = 0; k < stack->slices.size(); ++k)
    off = std::max(off, (position_of(stack->slices[k]) - origin - static_cast<double>(k) * step).norm());
  const double tilt = std::acos(std::min(1.0, normal_of(first).dot(step.normalized()))) * 180.0 / std::numbers::pi;
  if (tilt > kLeastTiltDeg) {
    stack->remarks.push_back(
        absl::StrFormat("the gantry leans by %.1f degrees: the slices are sheared to where they were taken", tilt));
  }
  if (off <= std::max(kEvenMm, kEvenPart * stack->slice_spacing)) return;
  for (const DicomFrame& slice : stack->slices) stack->slice_origins.push_back(slice.position);
  stack->remarks.push_back(
      absl::StrFormat("slices lie %.2f to %.2f mm apart, and %.2f mm from even places at most: each "
                      "is kept where it is",
                      smallest_gap, widest_gap, off));
}

}  // namespace

absl::StatusOr<DicomStack> stack_slices(std::vector<DicomFrame> images, bool bridge_gaps) {
  DicomStack stack;
  leave_out(&images, &stack.remarks);
  if (auto status = check_each(images); !status.ok()) return status;
  if (images.size() < 2)
    return refuse(
        absl::StrCat("it has ", images.size(), " slice, a volume has at least 2: name the folder of all slices"));
  if (auto status = check_alike(images); !status.ok()) return status;
  stack.orientation = name_of_orientation(images.front());
  const Vector3d normal = normal_of(images.front());
  const auto along = [&normal](const DicomFrame& frame) { return normal.dot(position_of(frame)); };
  std::stable_sort(images.begin(), images.end(),
                   [&](const DicomFrame& a, const DicomFrame& b) { return along(a) < along(b); });
  std::vector<double> at, gaps;
  for (const DicomFrame& image : images) at.push_back(along(image));
  for (size_t k = 0; k + 1 < at.size(); ++k) gaps.push_back(at[k + 1] - at[k]);
  if (auto status = check_places(at, gaps); !status.ok()) return status;
  if (auto status = check_gaps(at, gaps, bridge_gaps, &stack.remarks); !status.ok()) return status;
  stack.slice_spacing = median_of(gaps);
  stack.slices = std::move(images);
  const auto [smallest, widest] = std::minmax_element(gaps.begin(), gaps.end());
  set_map(&stack, *smallest, *widest);
  const int64_t promised = stack.slices.front().images_in_acquisition;
  if (promised > static_cast<int64_t>(stack.slices.size())) {
    stack.remarks.push_back(absl::StrCat("the headers speak of ", promised, " images, ", stack.slices.size(),
                                         " are here: the series may be cut short"));
  }
  return stack;
}

}  // namespace lipofill::client
