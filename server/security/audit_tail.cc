#include "server/security/audit_tail.h"

#include <filesystem>
#include <fstream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

/// A line has a few hundred bytes, at most some sixty names.
constexpr std::streamoff kTail = 1 << 20;

std::string read_tail(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : 0;
  std::string text(static_cast<size_t>(std::min(size, kTail)), '\0');
  file.seekg(size - static_cast<std::streamoff>(text.size()));
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

/// "{path}.000000000042" with the largest number; empty where there is none.
std::string newest_kept_file(const std::string& path) {
  const std::filesystem::path whole = std::filesystem::absolute(path);
  const std::string start = whole.filename().string() + ".";
  std::string newest;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(whole.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    const bool is_kept = absl::StartsWith(name, start) && name.size() == start.size() + 12 &&
                         name.find_first_not_of("0123456789", start.size()) == std::string::npos;
    if (is_kept && entry.path().string() > newest) newest = entry.path().string();
  }
  return newest;
}

}  // namespace

absl::StatusOr<AuditTail> find_audit_tail(const std::string& path) {
  std::string text = read_tail(path);
  AuditTail tail;
  tail.is_torn = !text.empty() && text.back() != '\n';
  if (text.empty()) text = read_tail(newest_kept_file(path));
  if (text.empty()) return tail;
  if (text.back() == '\n') text.pop_back();
  bool is_last = true;
  while (true) {
    const size_t end_before = text.rfind('\n');
    const std::string line = end_before == std::string::npos ? text : text.substr(end_before + 1);
    if (is_last) tail.head.hash = hash_of_line(line);
    is_last = false;
    AuditHead told;
    if (read_audit_line(line, told)) {
      tail.head.number = told.number;
      tail.whole = {told.number, hash_of_line(line)};
      return tail;
    }
    if (end_before == std::string::npos) break;
    text.resize(end_before);
  }
  return absl::DataLossError(
      absl::StrCat(path, " is no audit log, or damaged: none of its last lines can be read; move it away"));
}

}  // namespace lipofill::server
