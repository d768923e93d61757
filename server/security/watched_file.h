#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "server/security/small_file.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {

/// The content of a file, read again once the file has changed. A change that cannot be understood
/// is logged, and the earlier content still holds. Thread-safe. Checked by
/// tests/unit/server/security/watched_file_test.cc.
template <typename Content>
class WatchedFile {
 public:
  using Parse = std::function<absl::StatusOr<Content>(const std::string& text)>;

  /// The error of reading or of `parse` where the file cannot be used as it is now.
  static absl::StatusOr<std::unique_ptr<WatchedFile>> open(const std::string& path, Parse parse) {
    std::unique_ptr<WatchedFile> file(new WatchedFile(path, std::move(parse)));
    file->seen_ = stamp_of(path);
    auto content = file->read();
    if (!content.ok()) return content.status();
    file->content_ = std::make_shared<const Content>(*std::move(content));
    return file;
  }

  /// Looks at the file at most once in `kPeriod`.
  std::shared_ptr<const Content> get() {
    const std::lock_guard lock(mutex_);
    if (const auto now = Clock::now(); now >= next_look_) {
      next_look_ = now + kPeriod;
      look();
    }
    return content_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kPeriod{1};

  WatchedFile(std::string path, Parse parse) : path_(std::move(path)), parse_(std::move(parse)) {}

  absl::StatusOr<Content> read() const {
    const auto text = read_small_file(path_);
    if (!text.ok()) return text.status();
    return parse_(*text);
  }

  void look() {
    const FileStamp stamp = stamp_of(path_);
    if (stamp == seen_) return;
    seen_ = stamp;
    auto content = read();
    if (content.ok()) {
      content_ = std::make_shared<const Content>(*std::move(content));
      spdlog::info("{} has changed and is read again", path_);
    } else {
      spdlog::error("{} has changed and is not used: {}", path_, std::string(content.status().message()));
    }
  }

  const std::string path_;
  const Parse parse_;
  std::mutex mutex_;
  FileStamp seen_;
  Clock::time_point next_look_ = Clock::now() + kPeriod;
  std::shared_ptr<const Content> content_;
};

}  // namespace lipofill::server
