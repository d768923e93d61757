#include "client/cpp/dicom/dicom_source.h"

#include <archive.h>
#include <archive_entry.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

constexpr size_t kPiece = size_t{1} << 16;
constexpr uint64_t kMaxUnpackedBytes = uint64_t{4} << 30;
constexpr uint64_t kFreeBytes = uint64_t{256} << 20;
constexpr uint64_t kMaxRatio = 100;

/// A file of at least 132 bytes with "DICM" behind 128 of them.
bool has_preamble(const char* head, size_t size) {
  return size >= 132 && std::string_view(head + 128, 4) == "DICM";
}

bool begins_as(const std::filesystem::path& file, size_t offset, std::string_view magic) {
  std::array<char, 132> head{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), head.size());
  return std::string_view(head.data() + offset, magic.size()) == magic;
}

/// The allowance is what one zip may still unpack to.
class Allowance {
 public:
  explicit Allowance(const std::filesystem::path& zip) : zip_(zip) {
    std::error_code error;
    packed_ = std::filesystem::file_size(zip, error);
    left_ = all_ = DicomSource::allowed_bytes(error ? 0 : packed_);
  }
  absl::Status take(size_t bytes) {
    if (bytes <= left_) {
      left_ -= bytes;
      return absl::OkStatus();
    }
    return bad_volume(zip_, absl::StrCat("has ", packed_, " bytes and unpacks to more than the ", all_,
                                         " allowed: unpack it, look at it, and name the folder"));
  }

 private:
  std::filesystem::path zip_;
  uint64_t packed_ = 0, all_ = 0, left_ = 0;
};

/// Writes the entry at hand to `file` if it is DICOM; says whether it did.
absl::StatusOr<bool> unpack_entry(archive* stream, const std::filesystem::path& zip, const std::filesystem::path& file,
                                  Allowance* allowance) {
  std::vector<char> piece(kPiece);
  std::ofstream output;
  size_t filled = 0;
  while (true) {
    const la_ssize_t count = archive_read_data(stream, piece.data() + filled, piece.size() - filled);
    if (count < 0) return bad_volume(zip, "is damaged or cut short: copy it again");
    if (auto status = allowance->take(static_cast<size_t>(count)); !status.ok()) return status;
    filled += static_cast<size_t>(count);
    if (count > 0 && !output.is_open() && filled < 132) continue;
    if (!output.is_open()) {
      if (!has_preamble(piece.data(), filled)) return false;
      output.open(file, std::ios::binary);
    }
    output.write(piece.data(), static_cast<std::streamsize>(filled));
    filled = 0;
    if (!output)
      return absl::ResourceExhaustedError(absl::StrCat("cannot write ", file.string(), ": is the disk full?"));
    if (count == 0) return true;
  }
}

}  // namespace

/// A folder of its own, gone with the last that uses it.
struct DicomSource::Scratch {
  std::filesystem::path folder;
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "lipofill-dicom-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) folder = name;
  }
  ~Scratch() {
    std::error_code ignored;
    if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
};

uint64_t DicomSource::allowed_bytes(uint64_t zip_bytes) {
  return std::min(kMaxUnpackedBytes, kFreeBytes + kMaxRatio * std::min(zip_bytes, kMaxUnpackedBytes));
}

bool DicomSource::is_dicom(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return true;
  const std::string extension = absl::AsciiStrToLower(path.extension().string());
  if (extension == ".zip" || extension == ".dcm" || extension == ".dicom" || extension == ".ima") return true;
  return begins_as(path, 128, "DICM") || begins_as(path, 0, "PK\x03\x04");
}

absl::StatusOr<DicomSource> DicomSource::open(const std::filesystem::path& path) {
  DicomSource source;
  std::error_code error;
  absl::Status status;
  if (std::filesystem::is_directory(path, error)) {
    status = source.take_folder(path);
  } else if (!std::filesystem::is_regular_file(path, error)) {
    status = bad_volume(path, "does not exist or is not a file or folder");
  } else if (begins_as(path, 0, "PK\x03\x04") || absl::AsciiStrToLower(path.extension().string()) == ".zip") {
    status = source.unpack(path);
  } else if (absl::AsciiStrToUpper(path.filename().string()) == "DICOMDIR") {
    status = source.take_folder(path.parent_path().empty() ? "." : path.parent_path());
  } else {
    source.files_ = {path};
  }
  if (!status.ok()) return status;
  return source;
}

absl::Status DicomSource::take_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::recursive_directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (!entry->is_regular_file(ignored)) continue;
    files_.push_back(entry->path());
    if (files_.size() > kMaxFiles)
      return bad_volume(folder, absl::StrCat("holds more than ", kMaxFiles, " files: name the folder of one study"));
  }
  if (error) return bad_volume(folder, absl::StrCat("cannot be read: ", error.message()));
  std::sort(files_.begin(), files_.end());
  return absl::OkStatus();
}

absl::Status DicomSource::unpack(const std::filesystem::path& zip) {
  scratch_ = std::make_shared<Scratch>();
  if (scratch_->folder.empty()) return absl::ResourceExhaustedError("no folder can be made to unpack a zip in");
  const std::unique_ptr<archive, decltype(&archive_read_free)> stream(archive_read_new(), &archive_read_free);
  archive_read_support_format_zip(stream.get());
  if (archive_read_open_filename(stream.get(), zip.c_str(), kPiece) != ARCHIVE_OK)
    return bad_volume(zip, "is not a zip, or is damaged: copy it again");
  Allowance allowance(zip);
  archive_entry* entry = nullptr;
  size_t entries = 0;
  while (true) {
    const int result = archive_read_next_header(stream.get(), &entry);
    if (result == ARCHIVE_EOF) return absl::OkStatus();
    if (result != ARCHIVE_OK && result != ARCHIVE_WARN)
      return bad_volume(zip, "is damaged or cut short: copy it again");
    if (++entries > kMaxFiles)
      return bad_volume(zip, absl::StrCat("holds more than ", kMaxFiles, " files: pack one study alone"));
    if (archive_entry_is_encrypted(entry) > 0)
      return bad_volume(zip, "is encrypted: unpack it with its password, and name the folder");
    if (archive_entry_filetype(entry) != AE_IFREG) continue;
    const auto file = scratch_->folder / absl::StrFormat("%06d.dcm", entries);
    const auto unpacked = unpack_entry(stream.get(), zip, file, &allowance);
    if (!unpacked.ok()) return unpacked.status();
    if (*unpacked) files_.push_back(file);
  }
}

}  // namespace lipofill::client
