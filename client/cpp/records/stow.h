#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace lipofill::client {

/// An archive that takes objects over the web (DICOMweb), and how it is spoken to.
struct WebArchive {
  std::string url;       ///< of the service, such as https://pacs.example/dicom-web
  std::string ca_file;   ///< certificates that vouch for it; empty: those of the system
  std::string user;      ///< empty: none
  std::string password;  ///< of the user
  std::string token;     ///< a bearer token in place of user and password; empty: none
};

/// Tells whether an address of a PACS is that of a web service.
bool is_web_address(const std::string& address);

/// Sends files of DICOM by STOW-RS (PS3.18, 10.5), one request a file, so that memory for one piece
/// of it is enough and what is refused has a name. TLS is that of libcurl, 1.2 or later, and the
/// certificate must be good for the host. A password or a token goes over TLS alone. UNAVAILABLE
/// where the archive cannot be reached or is not who it says, PERMISSION_DENIED where it wants
/// another user, FAILED_PRECONDITION with its reason for an object that it did not take. Checked by
/// tests/python/test_records.py against Orthanc with its DICOMweb plugin.
absl::Status send_to_web_archive(const WebArchive& archive, const std::vector<std::filesystem::path>& files);

}  // namespace lipofill::client
