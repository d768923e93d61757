#include "client/cpp/scan_upload.h"

#include <openssl/evp.h>

#include <fstream>
#include <memory>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/errors.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

constexpr int kMaxAttempts = 5;

absl::StatusOr<uint64_t> size_of_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return absl::InvalidArgumentError(absl::StrCat("scan file ", file.string(), " does not exist or is not a file"));
  }
  const uint64_t size = std::filesystem::file_size(file, error);
  if (error) return absl::InvalidArgumentError(absl::StrCat("cannot read ", file.string(), ": ", error.message()));
  return size;
}

/// Lower-case hex of a digest.
std::string hex(const unsigned char* digest, unsigned int size) {
  return absl::BytesToHexString(absl::string_view(reinterpret_cast<const char*>(digest), size));
}

std::string sha256_of_text(const std::string& text) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_Digest(text.data(), text.size(), digest, &size, EVP_sha256(), nullptr);
  return hex(digest, size);
}

/// Announces the scan. The request id is made of its content, so that a repeated call finds what
/// the first one began.
absl::StatusOr<v1::Scan> announce(const Connection& connection, const std::string& parent,
                                  const std::filesystem::path& file, v1::ScanUnit unit) {
  const auto format = scan_format_of(file);
  if (!format.ok()) return format.status();
  const auto size = size_of_file(file);
  if (!size.ok()) return size.status();
  const auto sha256 = sha256_of_file(file);
  if (!sha256.ok()) return sha256.status();
  v1::CreateScanRequest request;
  request.set_request_id(
      sha256_of_text(absl::StrCat(parent, " ", *sha256, " ", static_cast<int>(*format), " ", static_cast<int>(unit))));
  request.set_parent(parent);
  request.set_format(*format);
  request.set_unit(unit == v1::SCAN_UNIT_UNSPECIFIED ? v1::MILLIMETRE : unit);
  request.set_size_bytes(*size);
  request.set_sha256(*sha256);
  return connection.call<v1::PatientService>(&v1::PatientService::Stub::CreateScan, request);
}

/// Sends what is missing from `received_bytes` on, in one stream.
absl::StatusOr<v1::Scan> send_rest(const Connection& connection, const v1::Scan& scan,
                                   const std::filesystem::path& file, const UploadProgress& progress) {
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(scan.received_bytes()));
  if (!stream) return absl::InvalidArgumentError(absl::StrCat("cannot read ", file.string()));
  const auto stub = v1::PatientService::NewStub(connection.channel());
  grpc::ClientContext context;
  std::stop_callback cancel(connection.stop(), [&context] { context.TryCancel(); });
  v1::Scan completed;
  const auto writer = stub->UploadScan(&context, &completed);
  v1::UploadScanRequest chunk;
  chunk.set_name(scan.name());
  uint64_t offset = scan.received_bytes();
  std::vector<char> buffer(kUploadChunkBytes);
  // The first message goes also where all bytes are there already: the daemon may have ended before
  // it could complete the scan.
  while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())),
         stream.gcount() > 0 || !chunk.name().empty()) {
    chunk.set_offset(offset);
    chunk.set_data(buffer.data(), static_cast<size_t>(stream.gcount()));
    if (!writer->Write(chunk)) break;
    chunk.clear_name();
    offset += static_cast<uint64_t>(stream.gcount());
    if (progress) progress(offset, scan.size_bytes());
  }
  writer->WritesDone();
  const absl::Status status = status_of(writer->Finish(), connection.server());
  if (!status.ok()) return status;
  return completed;
}

}  // namespace

absl::StatusOr<v1::ScanFormat> scan_format_of(const std::filesystem::path& file) {
  const std::string extension = absl::AsciiStrToLower(file.extension().string());
  if (extension == ".obj") return v1::OBJ;
  if (extension == ".ply") return v1::PLY;
  if (extension == ".stl") return v1::STL;
  if (extension == ".glb" || extension == ".gltf") {
    return absl::InvalidArgumentError(absl::StrCat("scan file ", file.string(),
                                                   ": glTF is converted first: lipofill scan convert ", file.string(),
                                                   " --out face.ply"));
  }
  return absl::InvalidArgumentError(
      absl::StrCat("scan file ", file.string(), ": '", extension, "' is not one of .obj, .ply, .stl"));
}

absl::StatusOr<std::string> sha256_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return absl::InvalidArgumentError(absl::StrCat("cannot read ", file.string()));
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  bool good = context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  std::vector<char> buffer(kUploadChunkBytes);
  while (good && (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), stream.gcount() > 0)) {
    good = EVP_DigestUpdate(context.get(), buffer.data(), static_cast<size_t>(stream.gcount())) == 1;
  }
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  good = good && EVP_DigestFinal_ex(context.get(), digest, &size) == 1;
  if (!good || stream.bad()) return absl::InternalError(absl::StrCat("cannot hash ", file.string()));
  return hex(digest, size);
}

absl::StatusOr<v1::Scan> upload_scan(const Connection& connection, const std::string& parent,
                                     const std::filesystem::path& file, v1::ScanUnit unit,
                                     const UploadProgress& progress) {
  auto scan = announce(connection, parent, file, unit);
  for (int attempt = 1; scan.ok() && !scan->complete(); ++attempt) {
    auto sent = send_rest(connection, *scan, file, progress);
    if (sent.ok() || !absl::IsUnavailable(sent.status()) || attempt == kMaxAttempts) return sent;
    v1::GetScanRequest request;
    request.set_name(scan->name());
    scan = connection.call<v1::PatientService>(&v1::PatientService::Stub::GetScan, request);
  }
  return scan;
}

}  // namespace lipofill::client
