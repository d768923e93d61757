#include "client/cpp/volume/value_range.h"

#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkSetGet.h>

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr size_t kBins = 256;
using Histogram = std::array<double, kBins>;

template <typename T>
Histogram count_values(vtkDataArray* values, double least, double most) {
  Histogram histogram{};
  const T* const voxels = static_cast<const T*>(values->GetVoidPointer(0));
  const double scale = static_cast<double>(kBins) / (most - least);
  for (vtkIdType k = 0; k < values->GetNumberOfTuples(); ++k) {
    const double bin = (static_cast<double>(voxels[k]) - least) * scale;
    histogram[std::min(static_cast<size_t>(std::max(bin, 0.0)), kBins - 1)] += 1.0;
  }
  return histogram;
}

/// The bin behind which Otsu's threshold lies.
size_t otsu_bin(const Histogram& histogram) {
  double total = 0.0, total_moment = 0.0;
  for (size_t bin = 0; bin < kBins; ++bin) {
    total += histogram[bin];
    total_moment += static_cast<double>(bin) * histogram[bin];
  }
  size_t best_bin = 0;
  double best = -1.0, below = 0.0, moment = 0.0;
  for (size_t bin = 0; bin + 1 < kBins; ++bin) {
    below += histogram[bin];
    moment += static_cast<double>(bin) * histogram[bin];
    const double above = total - below;
    if (below == 0.0 || above == 0.0) continue;
    const double apart = moment / below - (total_moment - moment) / above;
    const double between = below * above * apart * apart;
    if (between <= best) continue;
    best = between;
    best_bin = bin;
  }
  return best_bin;
}

Histogram histogram_of(vtkDataArray* values, double least, double most) {
  switch (values->GetDataType()) { vtkTemplateMacro(return count_values<VTK_TT>(values, least, most)); }
  return {};
}

}  // namespace

ValueRange find_value_range(const Volume& volume) {
  vtkDataArray* values = volume.voxels->GetPointData()->GetScalars();
  const double* bounds = values->GetRange(0);
  const double least = bounds[0], most = bounds[1];
  double threshold = least;
  if (most > least) {
    const double bin = static_cast<double>(otsu_bin(histogram_of(values, least, most)) + 1);
    threshold = least + bin * (most - least) / static_cast<double>(kBins);
  }
  const auto meant = [&](double voxel) { return volume.slope * voxel + volume.intercept; };
  return {std::min(meant(least), meant(most)), std::max(meant(least), meant(most)), meant(threshold)};
}

std::string explain_no_surface(const Volume& volume, double isovalue) {
  const ValueRange range = find_value_range(volume);
  if (range.least == range.most) {
    return absl::StrCat("has no surface at the value ", isovalue, ": all of its voxels have the value ", range.least,
                        ", so it shows nothing");
  }
  return absl::StrCat("has no surface at the value ", isovalue, ": its values go from ", range.least, " to ",
                      range.most, "; try --isovalue ", range.threshold,
                      ", where its darker and its brighter voxels part (Otsu's threshold)");
}

}  // namespace lipofill::client
