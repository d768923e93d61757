// Volumes of a CT: the first byte picks the format, the rest is the file.

#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <cmath>

#include "client/cpp/volume/invesalius.h"
#include "client/cpp/volume/volume_reader.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static constexpr const char* kNames[] = {"volume.mha",   "volume.nrrd", "volume.nii", "volume.nii.gz",
                                           "project.inv3", "volume.nhdr", "volume.hdr"};
  if (size == 0) return 0;
  const std::string name = kNames[data[0] % 7];
  const auto file = lipofill::fuzz::write_scratch_file(name, lipofill::fuzz::as_text(data + 1, size - 1));
  if (name == "project.inv3") {
    (void)lipofill::client::convert_invesalius(file, file.parent_path() / "converted.mha");
    return 0;
  }
  const auto volume = lipofill::client::read_volume(file);
  if (!volume.ok()) return 0;
  const vtkIdType points = volume->voxels->GetNumberOfPoints();
  lipofill::fuzz::require(volume->voxels->GetPointData()->GetScalars()->GetNumberOfTuples() == points,
                          "voxels fill the volume's size");
  for (const double entry : volume->index_to_mm) lipofill::fuzz::require(std::isfinite(entry), "places are finite");
  return 0;
}
