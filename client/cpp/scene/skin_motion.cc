#include "client/cpp/scene/skin_motion.h"

#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <regex>
#include <string>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/io/vtp_file.h"
#include "client/cpp/json_file.h"
#include "client/cpp/picture/surface.h"

namespace lipofill::client {
namespace {

struct TimedFile {
  double time_s = 0.0;
  std::filesystem::path file;
};

/// The files of a ParaView collection that a run has written.
absl::StatusOr<std::vector<TimedFile>> read_collection(const std::filesystem::path& folder) {
  std::filesystem::path collection = folder / "scan.pvd";
  if (!std::filesystem::exists(collection)) collection = folder / "skin.pvd";
  const auto text = read_text_file(collection);
  if (!text.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat(folder.string(),
                     " is not a folder that lipofill run or lipofill export has written: ", text.status().message()));
  }
  static const std::regex pattern(R"re(timestep="([^"]*)"[^>]*file="((?:scan|skin)_\d{4,}\.vtp)")re");
  std::vector<TimedFile> files;
  for (std::sregex_iterator match(text->begin(), text->end(), pattern), end; match != end; ++match) {
    TimedFile file;
    if (!absl::SimpleAtod((*match)[1].str(), &file.time_s))
      return absl::InvalidArgumentError(absl::StrCat(collection.string(), " has the time '", (*match)[1].str(), "'"));
    file.file = folder / (*match)[2].str();
    files.push_back(file);
  }
  if (files.empty()) return absl::InvalidArgumentError(absl::StrCat(collection.string(), " names no file of a skin"));
  return files;
}

/// Every so many, evenly, the first and the last among them.
std::vector<TimedFile> take_evenly(const std::vector<TimedFile>& all, size_t most) {
  if (all.size() <= most) return all;
  if (most == 1) return {all.back()};
  std::vector<TimedFile> taken;
  for (size_t k = 0; k < most; ++k) taken.push_back(all[k * (all.size() - 1) / (most - 1)]);
  return taken;
}

absl::StatusOr<Surface> read_still(const std::filesystem::path& file) {
  auto surface = read_vtp(file);
  if (!surface.ok()) return surface;
  vtkDataArray* const displacement = (*surface)->GetPointData()->GetArray(kDisplacement);
  if (displacement == nullptr || displacement->GetNumberOfComponents() != 3)
    return absl::InvalidArgumentError(
        absl::StrCat(file.string(), " is no skin with ", kDisplacement, " on its points"));
  return surface;
}

std::vector<std::array<uint32_t, 3>> triangles_of(vtkPolyData* surface) {
  std::vector<std::array<uint32_t, 3>> triangles;
  const auto cells = vtk::TakeSmartPointer(surface->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell()) {
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCurrentCell(size, ids);
    for (vtkIdType k = 2; k < size; ++k) {
      triangles.push_back(
          {static_cast<uint32_t>(ids[0]), static_cast<uint32_t>(ids[k - 1]), static_cast<uint32_t>(ids[k])});
    }
  }
  return triangles;
}

std::vector<double> values_of(vtkPolyData* surface, const char* field) {
  std::vector<double> values(static_cast<size_t>(surface->GetNumberOfPoints()), 0.0);
  if (vtkDataArray* const array = surface->GetPointData()->GetArray(field); array != nullptr) {
    for (size_t k = 0; k < values.size(); ++k) values[k] = array->GetComponent(static_cast<vtkIdType>(k), 0);
  }
  return values;
}

Eigen::Matrix3Xf displacement_of(vtkPolyData* surface) {
  vtkDataArray* const array = surface->GetPointData()->GetArray(kDisplacement);
  Eigen::Matrix3Xf values(3, array->GetNumberOfTuples());
  for (vtkIdType k = 0; k < array->GetNumberOfTuples(); ++k) {
    for (int c = 0; c < 3; ++c) values(c, k) = static_cast<float>(array->GetComponent(k, c));
  }
  return values;
}

void take_rest(vtkPolyData* surface, const Eigen::Matrix3Xf& displacement, SkinMotion* motion) {
  motion->triangles = triangles_of(surface);
  motion->rest_mm.resize(3, surface->GetNumberOfPoints());
  for (vtkIdType k = 0; k < surface->GetNumberOfPoints(); ++k) surface->GetPoint(k, motion->rest_mm.col(k).data());
  motion->rest_mm -= displacement.cast<double>();
}

}  // namespace

absl::StatusOr<SkinMotion> read_skin_motion(const std::filesystem::path& folder, size_t most_stills) {
  const auto files = read_collection(folder);
  if (!files.ok()) return files.status();
  SkinMotion motion;
  for (const TimedFile& each : take_evenly(*files, most_stills)) {
    const auto surface = read_still(each.file);
    if (!surface.ok()) return surface.status();
    SkinStill still{each.time_s, displacement_of(*surface)};
    if (motion.stills.empty()) take_rest(*surface, still.displacement_mm, &motion);
    if (still.displacement_mm.cols() != motion.rest_mm.cols())
      return absl::InvalidArgumentError(
          absl::StrCat(each.file.string(), " has another number of points than the first"));
    motion.stills.push_back(std::move(still));
    motion.pressure_pa = values_of(*surface, kPressure);
    motion.thickness_mm = values_of(*surface, kThickness);
  }
  return motion;
}

}  // namespace lipofill::client
