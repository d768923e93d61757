#include "client/cpp/volume/label_mask.h"

#include <vtkPointData.h>
#include <vtkSetGet.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

constexpr size_t kMostValues = 4096;
constexpr size_t kMostNamed = 20;

/// Marks the voxels of the labels wanted, and lists all values there are, as far as they may be
/// labels.
template <typename T>
std::set<double> mark(const Volume& map, const std::set<double>& wanted, unsigned char* mask) {
  vtkDataArray* const values = map.voxels->GetPointData()->GetScalars();
  const T* const voxels = static_cast<const T*>(values->GetVoidPointer(0));
  std::set<double> found;
  double last = 0.0;
  bool last_is_wanted = false;
  for (vtkIdType k = 0; k < values->GetNumberOfTuples(); ++k) {
    const double value = map.slope * static_cast<double>(voxels[k]) + map.intercept;
    // Neighbours mostly have the same label.
    if (k == 0 || value != last) {
      last = value;
      last_is_wanted = wanted.empty() ? value != 0.0 : wanted.count(value) > 0;
      if (found.size() <= kMostValues) found.insert(value);
    }
    mask[k] = last_is_wanted ? 1 : 0;
  }
  return found;
}

std::set<double> mark_voxels(const Volume& map, const std::set<double>& wanted, unsigned char* mask) {
  switch (map.voxels->GetScalarType()) { vtkTemplateMacro(return mark<VTK_TT>(map, wanted, mask)); }
  return {};
}

/// "0, 1, 2, 7 and 12 more".
std::string list_of(const std::set<double>& found) {
  const auto shown = std::min(found.size(), kMostNamed);
  const std::vector<double> first(found.begin(), std::next(found.begin(), static_cast<std::ptrdiff_t>(shown)));
  const std::string more = found.size() > shown ? absl::StrCat(" and ", found.size() - shown, " more") : "";
  return absl::StrJoin(first, ", ") + more;
}

}  // namespace

absl::StatusOr<Volume> mask_labels(const std::filesystem::path& source, const Volume& map,
                                   const std::vector<int64_t>& labels) {
  const auto mask = vtkSmartPointer<vtkUnsignedCharArray>::New();
  mask->SetNumberOfTuples(map.voxels->GetNumberOfPoints());
  std::set<double> wanted;
  for (const int64_t label : labels) wanted.insert(static_cast<double>(label));
  const std::set<double> found = mark_voxels(map, wanted, mask->GetPointer(0));
  if (found.size() > kMostValues) {
    return bad_volume(source, absl::StrCat("is no label map: it has more than ", kMostValues,
                                           " different values; give an isovalue in place of a label"));
  }
  for (const double label : wanted) {
    if (found.count(label) > 0) continue;
    return bad_volume(source, absl::StrCat("has no voxel of label ", label, "; its labels are ", list_of(found)));
  }
  Volume result = map;
  result.voxels = vtkSmartPointer<vtkImageData>::New();
  result.voxels->SetDimensions(map.voxels->GetDimensions());
  result.voxels->GetPointData()->SetScalars(mask);
  result.slope = 1.0;
  result.intercept = 0.0;
  return result;
}

}  // namespace lipofill::client
