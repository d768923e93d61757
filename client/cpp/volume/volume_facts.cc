#include "client/cpp/volume/volume_facts.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cpp/io/vtk_messages.h"

namespace lipofill::client {
namespace {

constexpr int kPanel = 600;
constexpr int kGap = 12;
/// Air is black below this, bone white from there on [HU].
constexpr double kDarkest = -300.0, kBrightest = 1500.0;
/// Colours of labels, told apart by lightness too; they repeat.
constexpr std::array<std::array<uint8_t, 3>, 8> kLabelColours = {{{230, 159, 0},
                                                                  {86, 180, 233},
                                                                  {0, 158, 115},
                                                                  {240, 228, 66},
                                                                  {0, 114, 178},
                                                                  {213, 94, 0},
                                                                  {204, 121, 167},
                                                                  {170, 170, 170}}};

double length_of(const Affine& map, size_t axis) {
  return std::hypot(map[axis], map[4 + axis], map[8 + axis]);
}

/// The labels of a volume; none as soon as a value is no label.
std::map<int64_t, uint64_t> count_labels(const Volume& volume) {
  std::map<int64_t, uint64_t> counts;
  vtkDataArray* const voxels = volume.voxels->GetPointData()->GetScalars();
  int64_t last = 0;
  uint64_t* count = nullptr;
  for (vtkIdType k = 0; k < voxels->GetNumberOfTuples(); ++k) {
    const double value = volume.slope * voxels->GetComponent(k, 0) + volume.intercept;
    const auto label = static_cast<int64_t>(std::llround(value));
    if (count == nullptr || label != last) {
      const bool is_label = value == static_cast<double>(label) && label >= 0;
      if (!is_label) return {};
      count = &counts[label];
      last = label;
      if (counts.size() > kMostLabels && volume.label_names.empty()) return {};
    }
    ++*count;
  }
  return counts.size() > 1 ? counts : std::map<int64_t, uint64_t>();
}

/// The picture, a row of panels.
class Canvas {
 public:
  Canvas(int width, int height) : width_(width), height_(height) {
    pixels_.assign(static_cast<size_t>(3 * width * height), 40);
  }
  void put(int x, int y, const std::array<uint8_t, 3>& colour) {
    // PNG writers of VTK have the first row at the bottom.
    std::copy_n(colour.begin(), 3, pixels_.begin() + 3 * (static_cast<std::ptrdiff_t>(height_ - 1 - y) * width_ + x));
  }
  absl::Status write(const std::filesystem::path& png) const {
    vtkNew<vtkImageData> image;
    image->SetDimensions(width_, height_, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    std::copy(pixels_.begin(), pixels_.end(), static_cast<uint8_t*>(image->GetScalarPointer()));
    const VtkMessages messages;
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(png.c_str());
    writer->SetInputData(image);
    writer->Write();
    if (messages.error().empty()) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat("cannot write ", png.string(), ": ", messages.error()));
  }

 private:
  int width_, height_;
  std::vector<uint8_t> pixels_;
};

/// A slice across one axis; `across` runs to the right and `up` upwards in the picture.
struct Slice {
  size_t axis, across, up;
  int width = 0, height = 0;
};

std::array<uint8_t, 3> colour_of(double value, const VolumeFacts& facts) {
  if (!facts.labels.empty()) {
    if (value == 0.0) return {0, 0, 0};
    return kLabelColours[static_cast<size_t>(std::llround(value) - 1) % kLabelColours.size()];
  }
  const double low = std::max(facts.values.least, kDarkest);
  const double high = std::max(std::min(facts.values.most, kBrightest), low + 1e-9);
  const auto grey = static_cast<uint8_t>(std::lround(255.0 * std::clamp((value - low) / (high - low), 0.0, 1.0)));
  return {grey, grey, grey};
}

}  // namespace

VolumeFacts find_volume_facts(const Volume& volume) {
  VolumeFacts facts;
  volume.voxels->GetDimensions(facts.size.data());
  for (size_t axis = 0; axis < 3; ++axis) facts.spacing_mm[axis] = length_of(volume.index_to_mm, axis);
  facts.voxel_ml = facts.spacing_mm[0] * facts.spacing_mm[1] * facts.spacing_mm[2] * 1e-3;
  facts.frame = volume.frame;
  facts.values = find_value_range(volume);
  facts.labels = count_labels(volume);
  return facts;
}

absl::Status draw_slices(const Volume& volume, const VolumeFacts& facts, const std::filesystem::path& png) {
  std::array<Slice, 3> slices = {{{2, 0, 1}, {1, 0, 2}, {0, 1, 2}}};
  std::array<double, 3> extent{};
  for (size_t axis = 0; axis < 3; ++axis) extent[axis] = facts.spacing_mm[axis] * facts.size[axis];
  const double scale = kPanel / *std::max_element(extent.begin(), extent.end());
  int width = kGap, height = 0;
  for (Slice& slice : slices) {
    slice.width = std::max(1, static_cast<int>(scale * extent[slice.across]));
    slice.height = std::max(1, static_cast<int>(scale * extent[slice.up]));
    width += slice.width + kGap;
    height = std::max(height, slice.height + 2 * kGap);
  }
  Canvas canvas(width, height);
  vtkDataArray* const voxels = volume.voxels->GetPointData()->GetScalars();
  int left = kGap;
  for (const Slice& slice : slices) {
    for (int y = 0; y < slice.height; ++y) {
      for (int x = 0; x < slice.width; ++x) {
        std::array<vtkIdType, 3> at{};
        at[slice.axis] = facts.size[slice.axis] / 2;
        at[slice.across] = static_cast<vtkIdType>(x) * facts.size[slice.across] / slice.width;
        const vtkIdType from_top = static_cast<vtkIdType>(y) * facts.size[slice.up] / slice.height;
        // Axial slices are shown as scanners write them, the others with the head up.
        at[slice.up] = slice.axis == 2 ? from_top : facts.size[slice.up] - 1 - from_top;
        const vtkIdType id = at[0] + facts.size[0] * (at[1] + static_cast<vtkIdType>(facts.size[1]) * at[2]);
        canvas.put(left + x, kGap + y, colour_of(volume.slope * voxels->GetComponent(id, 0) + volume.intercept, facts));
      }
    }
    left += slice.width + kGap;
  }
  return canvas.write(png);
}

}  // namespace lipofill::client
