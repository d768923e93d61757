#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// Finds a program beside this one, or on PATH; empty when it is nowhere.
std::filesystem::path find_program(const std::string& name);

/// The file of this program itself.
std::filesystem::path this_program();

/// Starts a program with its output going to a file, in a process group of its own when `detached`
/// (the terminal's Ctrl-C then does not reach it). It is sent SIGTERM when this program dies in
/// whatever way. Variables that set up a daemon (LIPOFILLD_...) are not handed on.
absl::StatusOr<pid_t> start_process(const std::vector<std::string>& command, const std::filesystem::path& log,
                                    bool detached);

/// Starts a program, waits for its end, and returns its exit code (128 + signal when a signal ended
/// it).
absl::StatusOr<int> run_process(const std::vector<std::string>& command, const std::filesystem::path& log);

/// A new folder under the system's place for temporary files, and its end with it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace lipofill::client
