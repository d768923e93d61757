// The file of a checkpoint: the first byte says whether the rest is the whole file, or only the
// body, to which a header that fits is added: no made-up input ever has the right hash.

#include "absl/strings/escaping.h"
#include "core/base/hash.h"
#include "server/store/checkpoint_files.h"
#include "tests/fuzz/target.h"

namespace {

std::string add_header(std::string_view body) {
  std::string bytes("LIPOCKPT\1\0\0\0\0\0\0\0", 16);
  for (int k = 0; k < 8; ++k) bytes += static_cast<char>(body.size() >> (8 * k));
  lipofill::Hasher hasher;
  hasher.add_bytes(body.data(), body.size());
  return bytes.append(absl::HexStringToBytes(hasher.hex_digest())).append(body);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::string_view rest = lipofill::fuzz::as_text(data + 1, size - 1);
  const std::string file = data[0] % 2 == 0 ? std::string(rest) : add_header(rest);
  (void)lipofill::server::sha256_of_checkpoint(file);
  const auto content = lipofill::server::decode_checkpoint(file);
  if (!content.ok()) return 0;
  lipofill::fuzz::require(lipofill::server::encode_checkpoint(*content) == file, "what is read is written the same");
  return 0;
}
