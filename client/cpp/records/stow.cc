#include "client/cpp/records/stow.h"

#include <curl/curl.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"

namespace lipofill::client {
namespace {

constexpr size_t kMostAnswer = 1 << 20;
constexpr long kConnectTimeoutS = 20;
/// A link that moves less than this many bytes a second for so long is broken.
constexpr long kSlowest = 1;
constexpr long kSlowestS = 120;
constexpr char kFailedObjects[] = "00081198";
constexpr char kFailureReason[] = "00081197";

using Handle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;
using Headers = std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)>;
using Body = std::unique_ptr<curl_mime, decltype(&curl_mime_free)>;

size_t keep(char* bytes, size_t size, size_t count, void* kept) {
  auto* const answer = static_cast<std::string*>(kept);
  const size_t room = kMostAnswer - std::min(kMostAnswer, answer->size());
  answer->append(bytes, std::min(room, size * count));
  return size * count;
}

bool is_dicom_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(132, '\0');
  stream.read(head.data(), 132);
  return stream.gcount() == 132 && head.substr(128) == "DICM";
}

/// The reason that an answer gives for an object it did not take (PS3.18, 10.5.3); 0 without one.
int failure_in(const std::string& answer) {
  const auto document = nlohmann::json::parse(answer, nullptr, false);
  const nlohmann::json& top = document.is_array() && !document.empty() ? document[0] : document;
  if (!top.is_object() || !top.contains(kFailedObjects)) return 0;
  const nlohmann::json& failed = top[kFailedObjects];
  if (!failed.is_object() || !failed.contains("Value") || !failed["Value"].is_array() || failed["Value"].empty() ||
      !failed["Value"][0].is_object())
    return 0;
  const auto reason = failed["Value"][0].value(
      nlohmann::json::json_pointer(absl::StrCat("/", kFailureReason, "/Value/0")), nlohmann::json());
  return reason.is_number_integer() ? reason.get<int>() : -1;
}

absl::Status judge(const WebArchive& archive, const std::filesystem::path& file, long code, const std::string& answer) {
  if (code == 401 || code == 403) {
    return absl::PermissionDeniedError(absl::StrFormat(
        "%s does not let you send (HTTP %d): give --user and the password in LIPOFILL_PACS_PASSWORD, or "
        "a token in LIPOFILL_PACS_TOKEN",
        archive.url, code));
  }
  const int failure = failure_in(answer);
  if (code >= 200 && code < 300 && failure == 0) return absl::OkStatus();
  const std::string what = absl::StrFormat("%s did not take %s: HTTP %d", archive.url, file.string(), code);
  if (failure > 0) return absl::FailedPreconditionError(absl::StrFormat("%s, failure reason %04X", what, failure));
  if (code == 404)
    return absl::FailedPreconditionError(absl::StrCat(what, "; is that the address of its DICOMweb service?"));
  return absl::FailedPreconditionError(what);
}

void set_identity(const WebArchive& archive, CURL* handle) {
  if (!archive.ca_file.empty()) curl_easy_setopt(handle, CURLOPT_CAINFO, archive.ca_file.c_str());
  curl_easy_setopt(handle, CURLOPT_SSLVERSION, CURL_SSLVERSION_TLSv1_2);
  if (!archive.token.empty()) {
    curl_easy_setopt(handle, CURLOPT_HTTPAUTH, CURLAUTH_BEARER);
    curl_easy_setopt(handle, CURLOPT_XOAUTH2_BEARER, archive.token.c_str());
  } else if (!archive.user.empty()) {
    curl_easy_setopt(handle, CURLOPT_HTTPAUTH, CURLAUTH_BASIC);
    curl_easy_setopt(handle, CURLOPT_USERNAME, archive.user.c_str());
    curl_easy_setopt(handle, CURLOPT_PASSWORD, archive.password.c_str());
  }
}

absl::Status send_one(const WebArchive& archive, const std::filesystem::path& file, CURL* handle) {
  const Body body(curl_mime_init(handle), &curl_mime_free);
  curl_mimepart* const part = curl_mime_addpart(body.get());
  if (curl_mime_filedata(part, file.c_str()) != CURLE_OK)
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " cannot be read"));
  curl_mime_type(part, "application/dicom");
  // The name of a file may be that of a patient.
  curl_mime_filename(part, nullptr);
  const std::string url = absl::StrCat(absl::StripSuffix(archive.url, "/"), "/studies");
  curl_slist* lines = curl_slist_append(nullptr, "Content-Type: multipart/related; type=\"application/dicom\"");
  lines = curl_slist_append(lines, "Accept: application/dicom+json");
  lines = curl_slist_append(lines, "Expect:");
  const Headers headers(lines, &curl_slist_free_all);
  std::string answer;
  curl_easy_setopt(handle, CURLOPT_URL, url.c_str());
  curl_easy_setopt(handle, CURLOPT_MIMEPOST, body.get());
  curl_easy_setopt(handle, CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, &keep);
  curl_easy_setopt(handle, CURLOPT_WRITEDATA, &answer);
  const CURLcode sent = curl_easy_perform(handle);
  if (sent != CURLE_OK)
    return absl::UnavailableError(absl::StrCat("cannot reach ", archive.url, ": ", curl_easy_strerror(sent)));
  long code = 0;
  curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &code);
  return judge(archive, file, code, answer);
}

}  // namespace

bool is_web_address(const std::string& address) {
  return absl::StartsWithIgnoreCase(address, "https://") || absl::StartsWithIgnoreCase(address, "http://");
}

absl::Status send_to_web_archive(const WebArchive& archive, const std::vector<std::filesystem::path>& files) {
  const bool has_secret = !archive.token.empty() || !archive.user.empty();
  if (has_secret && !absl::StartsWithIgnoreCase(archive.url, "https://")) {
    return absl::InvalidArgumentError(absl::StrCat("a password or token is not sent to ", archive.url,
                                                   ", where anybody on the way could read it: use https://"));
  }
  for (const std::filesystem::path& file : files) {
    if (!is_dicom_file(file)) return absl::InvalidArgumentError(absl::StrCat(file.string(), " is not a file of DICOM"));
  }
  static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (ready != CURLE_OK) return absl::InternalError("libcurl cannot be made ready");
  // One handle keeps its connection from file to file.
  const Handle handle(curl_easy_init(), &curl_easy_cleanup);
  curl_easy_setopt(handle.get(), CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(handle.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(handle.get(), CURLOPT_CONNECTTIMEOUT, kConnectTimeoutS);
  curl_easy_setopt(handle.get(), CURLOPT_LOW_SPEED_LIMIT, kSlowest);
  curl_easy_setopt(handle.get(), CURLOPT_LOW_SPEED_TIME, kSlowestS);
  set_identity(archive, handle.get());
  for (const std::filesystem::path& file : files) {
    if (auto status = send_one(archive, file, handle.get()); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace lipofill::client
