#include "client/cpp/dicom/dicom_listing.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lipofill::client {
namespace {

DicomSeries make_series(std::vector<DicomFrame> images, bool bridge_gaps) {
  DicomSeries series;
  const DicomFrame& first = images.front();
  series.number = first.series_number;
  series.uid = first.series_uid;
  series.modality = first.modality;
  series.description = first.description;
  series.images = images.size();
  series.patient = first.patient;
  auto stack = stack_slices(std::move(images), bridge_gaps);
  if (stack.ok()) {
    series.stack = *std::move(stack);
  } else {
    series.problem = std::string(stack.status().message());
  }
  return series;
}

}  // namespace

uint64_t DicomSeries::voxels() const {
  if (stack.slices.empty()) return 0;
  return uint64_t{stack.slices.front().rows} * stack.slices.front().columns * stack.slices.size();
}

std::string DicomSeries::label() const {
  const std::string name = number >= 0 ? absl::StrCat(number) : uid;
  if (stack.slices.empty()) return absl::StrFormat("%s (%s, %d images)", name, modality, images);
  return absl::StrFormat("%s (%s, %d x %d x %d)", name, modality, stack.slices.front().columns,
                         stack.slices.front().rows, stack.slices.size());
}

DicomListing list_series(const DicomSource& source, bool bridge_gaps) {
  DicomListing listing;
  std::map<std::string, std::vector<DicomFrame>> images;
  std::set<size_t> patients;
  for (const std::filesystem::path& file : source.files()) {
    auto frames = read_dicom_frames(file);
    if (!frames.ok()) {
      const bool is_other = frames.status().message() == "is not DICOM";
      ++(is_other ? listing.other_files : listing.unreadable_files);
      if (!is_other && listing.first_unreadable.empty()) listing.first_unreadable = file.filename().string();
      continue;
    }
    if (frames->empty()) ++listing.without_image;
    for (DicomFrame& frame : *frames) {
      patients.insert(frame.patient);
      images[frame.series_uid].push_back(std::move(frame));
    }
  }
  for (auto& [uid, frames] : images) listing.series.push_back(make_series(std::move(frames), bridge_gaps));
  std::sort(listing.series.begin(), listing.series.end(), [](const DicomSeries& a, const DicomSeries& b) {
    return std::tie(a.number, a.uid) < std::tie(b.number, b.uid);
  });
  listing.patients = patients.size();
  return listing;
}

}  // namespace lipofill::client
