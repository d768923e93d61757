#include "server/backend/abandoned_uploads.h"

#include <algorithm>

#include "server/sessions/identifiers.h"
#include "server/sessions/thread_name.h"
#include "server/store/record_names.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr std::chrono::hours kPeriod{1};

std::chrono::duration<double> to_seconds(int64_t us) {
  return std::chrono::microseconds(us);
}

}  // namespace

int remove_abandoned_uploads(Backend& backend, std::chrono::duration<double> age, int64_t now_us) {
  const auto scans = backend.store.list_incomplete_scans();
  if (!scans.ok()) return 0;
  int removed = 0;
  for (const ScanRecord& scan : *scans) {
    const int64_t last_us = std::max(scan.create_time_us, backend.scan_files.last_write_us(scan.patient, scan.id));
    if (to_seconds(now_us - last_us) < age) continue;
    if (!backend.store.delete_scan(scan.patient, scan.id).ok()) continue;
    ++removed;
    spdlog::warn("{} is removed: {} of its {} bytes have come, and none for {:.0f} s", scan_name(scan.patient, scan.id),
                 scan.received_bytes, scan.size_bytes, to_seconds(now_us - last_us).count());
  }
  if (removed > 0) backend.temporary_files.remove_deleted();
  return removed;
}

UploadAttendant::UploadAttendant(Backend& backend, std::chrono::duration<double> age) {
  if (age.count() <= 0.0) return;
  thread_ = std::jthread([this, &backend, age](const std::stop_token& ending) {
    name_this_thread("uploads");
    std::unique_lock lock(mutex_);
    do {
      remove_abandoned_uploads(backend, age, now_us());
    } while (!wake_.wait_for(lock, ending, std::min<std::chrono::duration<double>>(kPeriod, age),
                             [&ending] { return ending.stop_requested(); }));
  });
}

UploadAttendant::~UploadAttendant() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

}  // namespace lipofill::server
