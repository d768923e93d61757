// DICOM segmentations: the input is a file.

#include "client/cpp/dicom/segmentation.h"

#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <cmath>

#include "client/cpp/volume/tissue_labels.h"
#include "client/cpp/volume/volume_facts.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto file = lipofill::fuzz::write_scratch_file("seg.dcm", lipofill::fuzz::as_text(data, size));
  (void)lipofill::client::is_segmentation(file);
  const auto volume = lipofill::client::read_segmentation(file);
  if (!volume.ok()) return 0;
  const vtkIdType points = volume->voxels->GetNumberOfPoints();
  lipofill::fuzz::require(volume->voxels->GetPointData()->GetScalars()->GetNumberOfTuples() == points,
                          "voxels fill the volume's size");
  for (const double entry : volume->index_to_mm) lipofill::fuzz::require(std::isfinite(entry), "places are finite");
  (void)lipofill::client::find_tissue_labels(file, volume->label_names, {"bone=1"});
  // A volume of many voxels takes long to pass over, and shows nothing more.
  constexpr vtkIdType kMostPoints = 1 << 20;
  if (points < kMostPoints) (void)lipofill::client::find_volume_facts(*volume);
  return 0;
}
