#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// A lipofilld of this program's own, on a free port of the loopback interface; it ends with the
/// object, however this program ends. Checked by tests/integration/cli/.
class PrivateDaemon {
 public:
  /// Starts one that keeps its state in `data` and waits until it answers. NOT_FOUND without a
  /// lipofilld beside this program or on PATH; INTERNAL, with the end of its log, when it does not
  /// come up.
  static absl::StatusOr<std::unique_ptr<PrivateDaemon>> start(const std::filesystem::path& data,
                                                              const std::stop_token& stop);
  ~PrivateDaemon();
  PrivateDaemon(const PrivateDaemon&) = delete;
  PrivateDaemon& operator=(const PrivateDaemon&) = delete;

  const std::string& server() const { return server_; }

 private:
  explicit PrivateDaemon(pid_t process) : process_(process) {}
  bool has_ended();
  absl::Status wait_for_port(const std::filesystem::path& port_file, const std::filesystem::path& log,
                             const std::stop_token& stop);

  pid_t process_;
  bool ended_ = false;
  std::string server_;
};

}  // namespace lipofill::client
