#include "server/ops/connection_metrics.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "server/ops/file_limit.h"

namespace lipofill::server {
namespace {

void raise_to(prometheus::Counter& counter, const std::atomic<uint64_t>& figure) {
  counter.Increment(static_cast<double>(figure) - counter.Value());
}

}  // namespace

void add_connection_metrics(const DoorFigures& door, Metrics& metrics) {
  auto& files = metrics.add_gauge("process_max_fds", "Files and connections that the daemon may hold open");
  auto& open = metrics.add_gauge("lipofill_connections", "Connections that are open");
  auto& accepted = metrics.add_counter("lipofill_connections_accepted_total", "Connections that were made");
  std::vector<prometheus::Counter*> refused;
  for (const char* reason : kTurnedAwayNames) {
    refused.push_back(&metrics.add_counter(absl::StrCat("lipofill_connections_", reason, "_total"),
                                           "Connections that were not taken or were ended for this reason"));
  }
  metrics.add_refresh([&door, &files, &open, &accepted, refused] {
    files.Set(static_cast<double>(file_limit()));
    open.Set(static_cast<double>(door.open));
    raise_to(accepted, door.accepted);
    for (size_t i = 0; i < refused.size(); ++i) raise_to(*refused[i], door.turned_away[i]);
  });
}

}  // namespace lipofill::server
