// The layout of a checkpoint in its file.

#include <array>
#include <cstring>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/hash.h"
#include "server/store/checkpoint_files.h"

namespace lipofill::server {
namespace {

constexpr std::string_view kMagic = "LIPOCKPT";
constexpr uint32_t kVersion = 1;
constexpr size_t kHashAt = 8 + 4 + 4 + 8;
constexpr size_t kHeaderBytes = kHashAt + 32;

template <typename Number>
void put(std::string& bytes, Number value) {
  for (size_t i = 0; i < sizeof value; ++i) bytes += static_cast<char>(value >> (8 * i));
}

void put_text(std::string& bytes, const std::string& text) {
  put(bytes, static_cast<uint64_t>(text.size()));
  bytes += text;
}

std::string hash_of(std::string_view body) {
  Hasher hasher;
  hasher.add_bytes(body.data(), body.size());
  return absl::HexStringToBytes(hasher.hex_digest());
}

/// Takes numbers and texts off the front; `ok` falls with the first that is not there.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  Number number() {
    const std::string_view raw = take(sizeof(Number));
    Number value = 0;
    for (size_t i = 0; i < raw.size(); ++i) {
      value |= static_cast<Number>(static_cast<Number>(static_cast<unsigned char>(raw[i])) << (8 * i));
    }
    return value;
  }
  std::string text() { return std::string(take(number<uint64_t>())); }
  std::string_view take(uint64_t size) {
    ok_ = ok_ && size <= bytes_.size();
    if (!ok_) return {};
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  bool ok() const { return ok_; }
  bool at_end() const { return ok_ && bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

absl::Status check_header(std::string_view bytes) {
  Reader reader(bytes);
  if (reader.take(kMagic.size()) != kMagic) return absl::DataLossError("it is no checkpoint");
  const auto version = reader.number<uint32_t>();
  if (reader.ok() && version != kVersion) {
    return absl::DataLossError(absl::StrCat("its format is ", version, ", this program knows ", kVersion));
  }
  const auto reserved = reader.number<uint32_t>();
  const auto size = reader.number<uint64_t>();
  const std::string_view hash = reader.take(kHeaderBytes - kHashAt);
  if (!reader.ok() || reserved != 0 || size != bytes.size() - kHeaderBytes) {
    return absl::DataLossError(absl::StrCat("it has ", bytes.size(), " bytes, which is not what it says"));
  }
  if (hash_of(bytes.substr(kHeaderBytes)) != hash) {
    return absl::DataLossError("its content is not what was written: the SHA-256 is another");
  }
  return absl::OkStatus();
}

}  // namespace

std::string encode_checkpoint(const CheckpointContent& content) {
  std::string body;
  body.reserve(content.spec_message.size() + content.snapshot.size() + 256);
  put(body, content.step);
  for (const std::string* text : {&content.simulation, &content.spec_message, &content.snapshot}) put_text(body, *text);
  std::string bytes(kMagic);
  bytes.reserve(kHeaderBytes + body.size());
  put(bytes, kVersion);
  put(bytes, uint32_t{0});
  put(bytes, static_cast<uint64_t>(body.size()));
  return bytes + hash_of(body) + body;
}

absl::StatusOr<CheckpointContent> decode_checkpoint(std::string_view bytes) {
  if (auto whole = check_header(bytes); !whole.ok()) return whole;
  Reader reader(bytes.substr(kHeaderBytes));
  CheckpointContent content;
  content.step = reader.number<uint64_t>();
  content.simulation = reader.text();
  content.spec_message = reader.text();
  content.snapshot = reader.text();
  if (!reader.at_end()) return absl::DataLossError("its parts are not as long as they say");
  return content;
}

std::string sha256_of_checkpoint(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) return "";
  return absl::BytesToHexString(std::string(bytes.substr(kHashAt, kHeaderBytes - kHashAt)));
}

}  // namespace lipofill::server
