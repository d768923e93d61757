#pragma once

#include <atomic>
#include <map>
#include <string>

#include "lipofill/v1/patient_service.grpc.pb.h"
#include "tests/integration/chaos/chaos_daemon.h"

namespace lipofill::testing {

/// Uploads scans and goes on where a dead daemon left off; a scan that was acknowledged to be
/// complete stays whole.
class Uploader {
 public:
  explicit Uploader(const ChaosDaemon& daemon) : daemon_(daemon) {}

  void run(const std::atomic<bool>& stop);
  /// Every complete scan is there and can still be read.
  void check();
  int complete() const { return static_cast<int>(complete_.size()); }

 private:
  void upload_one();
  /// Sends from what the daemon has on; true once it is complete.
  bool send_rest(const std::string& name, const std::string& bytes);

  const ChaosDaemon& daemon_;
  int scans_ = 0;
  std::map<std::string, std::string> complete_;  ///< name, SHA-256
};

}  // namespace lipofill::testing
