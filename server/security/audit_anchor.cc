#include "server/security/audit_anchor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "server/security/small_file.h"

namespace lipofill::server {
namespace {

using Json = nlohmann::json;

constexpr size_t kSlot = 1024;

std::string signed_text(const AuditHead& head) {
  return absl::StrCat("lipofill audit log, line ", head.number, ", hash ", head.hash);
}

std::string make_slot(const AuditHead& head, const AnchorKey* key) {
  const Json slot = {
      {"number", head.number}, {"hash", head.hash}, {"signature", key != nullptr ? key->sign(signed_text(head)) : ""}};
  std::string text = slot.dump();
  text.resize(kSlot - 1, ' ');
  return text + "\n";
}

std::optional<AuditHead> read_slot(const std::string& text, const AnchorKey* key) {
  const Json slot = Json::parse(text, nullptr, false);
  if (!slot.is_object() || !slot.contains("number") || !slot.contains("hash") || !slot.contains("signature")) {
    return std::nullopt;
  }
  if (!slot["number"].is_number_unsigned() || !slot["hash"].is_string() || !slot["signature"].is_string()) {
    return std::nullopt;
  }
  const AuditHead head{slot["number"].get<uint64_t>(), slot["hash"].get<std::string>()};
  if (key != nullptr && !key->has_signed(signed_text(head), slot["signature"].get<std::string>())) return std::nullopt;
  return head;
}

absl::Status check_end(const AuditHead& anchor, const AuditHead& head, const std::string& log) {
  constexpr char kNext[] = "; keep both files for whoever looks into it, move them away, and a new log begins";
  if (head.number < anchor.number) {
    return absl::DataLossError(absl::StrCat("the audit log ", log, " ends with line ", head.number,
                                            ", but its anchor has line ", anchor.number, ": its end was cut off",
                                            kNext));
  }
  if (head.number == anchor.number && head.hash != anchor.hash) {
    return absl::DataLossError(absl::StrCat("the last line of the audit log ", log, ", number ", head.number,
                                            ", is not the one that its anchor has: it was changed", kNext));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::optional<AuditHead>> read_anchor(const std::string& path, const AnchorKey* key) {
  // An empty one is of a log that has no line yet.
  std::error_code missing;
  if (std::filesystem::file_size(path, missing) == 0 || missing) return std::nullopt;
  const auto text = read_small_file(path);
  if (!text.ok()) return text.status();
  std::optional<AuditHead> newest;
  for (size_t at = 0; at < text->size(); at += kSlot) {
    const auto head = read_slot(text->substr(at, kSlot), key);
    if (head && (!newest || head->number > newest->number)) newest = head;
  }
  if (newest) return newest;
  return absl::DataLossError(absl::StrCat(path, " is no anchor of an audit log, or is damaged",
                                          key != nullptr ? ", or not signed with audit-key-file" : ""));
}

absl::StatusOr<std::unique_ptr<AuditAnchor>> AuditAnchor::open(const std::string& log, const AuditHead& head,
                                                               std::shared_ptr<const AnchorKey> key) {
  const std::string path = path_of(log);
  const auto anchor = read_anchor(path, key.get());
  if (!anchor.ok()) return anchor.status();
  if (*anchor) {
    if (auto fits = check_end(**anchor, head, log); !fits.ok()) return fits;
  }
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    return absl::FailedPreconditionError(absl::StrCat("cannot write ", path, ": ", std::strerror(errno)));
  }
  std::unique_ptr<AuditAnchor> self(new AuditAnchor(descriptor, path, std::move(key)));
  if (auto noted = self->note(head); !noted.ok()) return noted;
  return self;
}

AuditAnchor::~AuditAnchor() {
  ::close(descriptor_);
}

absl::Status AuditAnchor::note(const AuditHead& head) {
  const std::lock_guard lock(mutex_);
  if (head.number <= number_) return absl::OkStatus();
  const std::string slot = make_slot(head, key_.get());
  const ssize_t written = ::pwrite(descriptor_, slot.data(), slot.size(), slot_ * static_cast<off_t>(kSlot));
  if (written != static_cast<ssize_t>(slot.size())) {
    return absl::UnavailableError(absl::StrCat("cannot write ", path_, ": ", std::strerror(errno)));
  }
  number_ = head.number;
  slot_ = 1 - slot_;
  return absl::OkStatus();
}

}  // namespace lipofill::server
