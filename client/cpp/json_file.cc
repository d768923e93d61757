#include "client/cpp/json_file.h"

#include <fstream>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr std::uintmax_t kMaxTextBytes = 64u << 20;

/// Returns "at line 3, column 7: ..." without the library's own prefix.
std::string without_prefix(std::string message) {
  const size_t bracket = message.find("] ");
  return bracket == std::string::npos ? message : message.substr(bracket + 2);
}

}  // namespace

absl::StatusOr<std::string> read_text_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " does not exist or is not a file"));
  }
  if (std::filesystem::file_size(file, error) > kMaxTextBytes || error) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.string(), " is larger than the ", kMaxTextBytes >> 20, " MiB allowed"));
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return absl::InvalidArgumentError(absl::StrCat("cannot read ", file.string()));
  return text;
}

absl::StatusOr<nlohmann::json> read_json_file(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text.ok()) return text.status();
  try {
    return nlohmann::json::parse(*text);
  } catch (const nlohmann::json::exception& exception) {
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " is not JSON: ", without_prefix(exception.what())));
  }
}

absl::Status write_text_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path temporary = file.string() + ".part";
  {
    std::ofstream stream(temporary, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) return absl::InvalidArgumentError(absl::StrCat("cannot write ", temporary.string()));
  }
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) return absl::InvalidArgumentError(absl::StrCat("cannot write ", file.string(), ": ", error.message()));
  return absl::OkStatus();
}

}  // namespace lipofill::client
