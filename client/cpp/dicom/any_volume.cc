#include "client/cpp/dicom/any_volume.h"

#include "absl/strings/str_format.h"
#include "client/cpp/dicom/dicom_source.h"
#include "client/cpp/dicom/segmentation.h"

namespace lipofill::client {
namespace {

/// The segmentation that a source is, or that `series` names in it; empty where there is none.
std::filesystem::path find_segmentation(const DicomSource& source, const std::string& series) {
  if (series.empty()) {
    const bool is_one = source.files().size() == 1 && is_segmentation(source.files().front());
    return is_one ? source.files().front() : std::filesystem::path();
  }
  for (const std::filesystem::path& file : source.files()) {
    if (is_segmentation_of(file, series)) return file;
  }
  return {};
}

}  // namespace

absl::StatusOr<Volume> read_any_volume(const std::filesystem::path& path, const DicomReading& options) {
  if (is_volume_name(path) || !DicomSource::is_dicom(path)) return read_volume(path);
  {
    const auto source = DicomSource::open(path);
    if (!source.ok()) return source.status();
    const std::filesystem::path file = find_segmentation(*source, options.series);
    if (!file.empty()) return read_segmentation(file);
  }
  auto dicom = read_dicom_volume(path, options);
  if (!dicom.ok()) return dicom.status();
  dicom->volume.remarks.insert(
      dicom->volume.remarks.begin(),
      absl::StrFormat("series %d (%s, %d x %d x %d voxels of %.4g x %.4g x %.4g mm) was read", dicom->series_number,
                      dicom->modality, dicom->size[0], dicom->size[1], dicom->size[2], dicom->spacing_mm[0],
                      dicom->spacing_mm[1], dicom->spacing_mm[2]));
  return std::move(dicom->volume);
}

}  // namespace lipofill::client
