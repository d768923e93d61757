#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "server/backend/backend.h"

namespace lipofill::server {

/// Removes the scans of which some bytes have yet to come, and none has come for so long. Returns
/// how many. Complete scans are never touched. Checked by
/// tests/unit/server/backend/abandoned_uploads_test.cc.
int remove_abandoned_uploads(Backend& backend, std::chrono::duration<double> age, int64_t now_us);

/// Does so at the start, and every hour.
class UploadAttendant {
 public:
  /// With `age` 0 none is ever removed.
  UploadAttendant(Backend& backend, std::chrono::duration<double> age);
  ~UploadAttendant();

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace lipofill::server
