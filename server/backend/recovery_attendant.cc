#include "server/backend/recovery_attendant.h"

#include "server/backend/simulation_recovery.h"
#include "server/sessions/thread_name.h"

namespace lipofill::server {
namespace {

constexpr std::chrono::milliseconds kPeriod{100};

}  // namespace

RecoveryAttendant::RecoveryAttendant(Backend& backend) : backend_(backend) {
  thread_ = std::jthread([this](const std::stop_token& ending) {
    name_this_thread("recovery");
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, ending, kPeriod, [&ending] { return ending.stop_requested(); })) {
      for (const std::string& id : backend_.awaited.due()) {
        if (backend_.stopping || ending.stop_requested()) return;
        try_to_bring_back(backend_, id);
      }
    }
  });
}

RecoveryAttendant::~RecoveryAttendant() {
  thread_.request_stop();
  thread_.join();
}

}  // namespace lipofill::server
