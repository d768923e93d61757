#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/ops/metrics.h"

namespace lipofill::server {

/// The metrics over HTTP, path /metrics, in the text form of Prometheus. To be stopped (destroyed)
/// before what the refreshes of the metrics look at. Checked by
/// tests/integration/service/metrics_test.cc.
class MetricsServer {
 public:
  /// Starts the server. INVALID_ARGUMENT for an address that is no HOST:PORT, UNAVAILABLE when it
  /// cannot be listened on. The metrics must live longer.
  static absl::StatusOr<std::unique_ptr<MetricsServer>> start(const std::string& address, const Metrics& metrics);
  ~MetricsServer();

  int port() const { return port_; }

 private:
  struct Http;  // hides the library's header
  MetricsServer();

  std::unique_ptr<Http> http_;
  int port_ = 0;
};

}  // namespace lipofill::server
