#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "server/backend/backend.h"

namespace lipofill::server {

/// Tries again and again to bring back the simulations that wait for something, one after the
/// other, as long as there are any and this lives. Checked by
/// tests/integration/service/recovery_test.cc.
class RecoveryAttendant {
 public:
  explicit RecoveryAttendant(Backend& backend);
  ~RecoveryAttendant();

 private:
  Backend& backend_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace lipofill::server
