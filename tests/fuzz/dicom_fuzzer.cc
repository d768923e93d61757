// DICOM: the first byte picks a file or a zip, the rest is its bytes.

#include "client/cpp/dicom/dicom_frame.h"
#include "client/cpp/dicom/dicom_pixels.h"
#include "client/cpp/dicom/dicom_volume.h"
#include "tests/fuzz/target.h"

namespace {

/// Images that are fit for a volume have all the pixels that their header says.
void read_pixels(const std::filesystem::path& file) {
  const auto frames = lipofill::client::read_dicom_frames(file);
  if (!frames.ok()) return;
  lipofill::client::DicomPixels reader;
  std::vector<int32_t> pixels;
  constexpr size_t kMostFrames = 4;
  for (size_t k = 0; k < frames->size() && k < kMostFrames; ++k) {
    const auto& frame = (*frames)[k];
    if (!frame.problem.empty() || !reader.read(frame, &pixels).ok()) continue;
    lipofill::fuzz::require(pixels.size() == size_t{frame.rows} * frame.columns, "pixels fill the image");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const bool is_zip = data[0] % 2 == 1;
  const auto bytes = lipofill::fuzz::as_text(data + 1, size - 1);
  const auto file = lipofill::fuzz::write_scratch_file(is_zip ? "study.zip" : "image.dcm", bytes);
  if (!is_zip) read_pixels(file);
  const auto dicom = lipofill::client::read_dicom_volume(file, {});
  if (!dicom.ok()) return 0;
  int dimensions[3];
  dicom->volume.voxels->GetDimensions(dimensions);
  for (size_t k = 0; k < 3; ++k)
    lipofill::fuzz::require(static_cast<uint64_t>(dimensions[k]) == dicom->size[k], "voxels fill the series' size");
  return 0;
}
