#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// The address says where a PACS is, and who asks it.
struct PacsAddress {
  std::string title;  ///< its application entity title
  std::string host;
  uint16_t port = 0;
  std::string own_title = "LIPOFILL";
};

/// Reads "TITLE@HOST:PORT". INVALID_ARGUMENT for anything else, titles of more than 16 characters,
/// and ports that are none. Checked by tests/unit/client/records_test.cc.
absl::StatusOr<PacsAddress> parse_pacs_address(const std::string& text, const std::string& own_title);

/// The query says what to look for; an empty field means any. `*` and `?` stand for any characters.
struct PacsQuery {
  std::string patient_id;
  std::string accession_number;
  std::string study_date;  ///< YYYYMMDD, or FROM-TO
  std::string study_uid;
  std::string modality;
};

/// A series that a PACS has. It names no patient.
struct PacsSeries {
  std::string study_uid;
  std::string study_date;
  std::string series_uid;
  std::string series_number;
  std::string modality;
  std::string description;
  std::string images;  ///< how many; empty where the PACS does not say
};

/// Asks for series by C-FIND (study root): the studies, then the series of each. At most
/// kMostStudies studies are looked into, OUT_OF_RANGE beyond. UNAVAILABLE where the PACS cannot be
/// reached, PERMISSION_DENIED where it does not let this program in, INTERNAL for what else it
/// answers. Checked by tests/python/test_records.py against Orthanc.
absl::StatusOr<std::vector<PacsSeries>> find_in_pacs(const PacsAddress& pacs, const PacsQuery& query);

inline constexpr size_t kMostStudies = 200;

/// Sends files of DICOM by C-STORE, each in the transfer syntax that it has. The first that is not
/// taken ends it, with its name and what the PACS said. Checked by tests/python/test_records.py.
absl::Status send_to_pacs(const PacsAddress& pacs, const std::vector<std::filesystem::path>& files);

/// Fetches the images of a series, or of a whole study, by C-GET into a folder that must be empty
/// or new, under numbers: no name is taken from the PACS. Returns how many came. NOT_FOUND for
/// none. Checked by tests/python/test_records.py.
/// @param series_uid  empty: all series of the study
absl::StatusOr<size_t> fetch_from_pacs(const PacsAddress& pacs, const std::string& study_uid,
                                       const std::string& series_uid, const std::filesystem::path& folder);

}  // namespace lipofill::client
