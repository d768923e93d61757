#include "client/cpp/dicom/dicom_choice.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

constexpr size_t kMaxNamed = 8;

/// "1 (CT, 512 x 512 x 120), 2 (MR, 40 images)".
std::string labels_of(const std::vector<DicomSeries>& series) {
  std::vector<std::string> labels;
  for (const DicomSeries& each : series) {
    if (labels.size() == kMaxNamed) {
      labels.push_back(absl::StrCat("and ", series.size() - kMaxNamed, " more"));
      break;
    }
    labels.push_back(each.label());
  }
  return absl::StrJoin(labels, ", ");
}

/// Larger is better: a CT before an MR before others, axial before others, many voxels before few.
std::tuple<bool, bool, bool, uint64_t> rank_of(const DicomSeries& series) {
  return {series.modality == "CT", series.modality == "MR", series.stack.orientation == "axial", series.voxels()};
}

absl::StatusOr<DicomSeries> choose_default(const std::filesystem::path& source, const DicomListing& listing) {
  if (listing.patients > 1) {
    return bad_volume(source,
                      absl::StrCat("holds images of ", listing.patients, " patients: name the folder of one, or ",
                                   "the series with --series; there are ", labels_of(listing.series)));
  }
  std::vector<DicomSeries> usable;
  std::copy_if(listing.series.begin(), listing.series.end(), std::back_inserter(usable),
               [](const DicomSeries& series) { return series.problem.empty(); });
  if (usable.empty()) {
    const auto largest =
        std::max_element(listing.series.begin(), listing.series.end(),
                         [](const DicomSeries& a, const DicomSeries& b) { return a.images < b.images; });
    return bad_volume(
        source, absl::StrCat("holds no series that is a volume: of series ", largest->label(), ", ", largest->problem));
  }
  return *std::max_element(usable.begin(), usable.end(),
                           [](const DicomSeries& a, const DicomSeries& b) { return rank_of(a) < rank_of(b); });
}

}  // namespace

absl::Status check_has_images(const std::filesystem::path& source, const DicomListing& listing) {
  if (!listing.series.empty()) return absl::OkStatus();
  if (listing.other_files + listing.without_image + listing.unreadable_files == 0)
    return bad_volume(source,
                      "holds no DICOM image, only texts or nothing: name the folder or zip with those of a CT or MR");
  std::string what = "holds no DICOM image: ";
  absl::StrAppend(&what, listing.other_files, " files are no DICOM (empty, encrypted, or of another kind)");
  if (listing.without_image > 0) absl::StrAppend(&what, ", ", listing.without_image, " hold no image");
  if (listing.unreadable_files > 0)
    absl::StrAppend(&what, ", ", listing.unreadable_files, " are cut short, the first is ", listing.first_unreadable);
  return bad_volume(source, what + "; name the folder or zip that holds the images of a CT or MR");
}

absl::StatusOr<DicomSeries> choose_series(const std::filesystem::path& source, const DicomListing& listing,
                                          const std::string& wanted) {
  if (auto status = check_has_images(source, listing); !status.ok()) return status;
  if (wanted.empty()) {
    auto series = choose_default(source, listing);
    // A larger series may have been passed over for what is wrong with it.
    for (const DicomSeries& other : listing.series) {
      if (series.ok() && !other.problem.empty() && other.images > 1)
        series->stack.remarks.push_back(absl::StrCat("series ", other.label(), " was passed over: ", other.problem));
    }
    return series;
  }
  std::vector<DicomSeries> found;
  for (const DicomSeries& series : listing.series) {
    if (series.uid == wanted || absl::StrCat(series.number) == wanted) found.push_back(series);
  }
  if (found.empty())
    return bad_volume(source, absl::StrCat("has no series ", wanted, "; there are ", labels_of(listing.series)));
  if (found.size() > 1) {
    std::vector<std::string> uids;
    for (const DicomSeries& series : found) uids.push_back(series.uid);
    return bad_volume(source, absl::StrCat("has ", found.size(), " series of number ", wanted,
                                           ": name one by its UID, ", absl::StrJoin(uids, " or ")));
  }
  if (found[0].problem.empty()) return found[0];
  return bad_volume(source, absl::StrCat("has a series ", found[0].label(), " that is no volume: ", found[0].problem));
}

}  // namespace lipofill::client
