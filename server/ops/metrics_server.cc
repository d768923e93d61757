#include "server/ops/metrics_server.h"

#include <httplib.h>
#include <prometheus/text_serializer.h>

#include <thread>

#include "absl/strings/str_cat.h"
#include "server/ops/listen_address.h"

namespace lipofill::server {
namespace {

constexpr int kThreads = 2;
constexpr time_t kTimeoutSeconds = 5;

/// The library's own choice would let two daemons share a port unnoticed.
void set_socket_options(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

}  // namespace

struct MetricsServer::Http {
  httplib::Server server;
  std::thread thread;
};

MetricsServer::MetricsServer() : http_(std::make_unique<Http>()) {}

MetricsServer::~MetricsServer() {
  http_->server.stop();
  if (http_->thread.joinable()) http_->thread.join();
}

absl::StatusOr<std::unique_ptr<MetricsServer>> MetricsServer::start(const std::string& address,
                                                                    const Metrics& metrics) {
  const auto place = parse_listen_address(address);
  if (!place.ok()) return place.status();
  std::unique_ptr<MetricsServer> self(new MetricsServer());
  httplib::Server& server = self->http_->server;
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server.set_socket_options(set_socket_options);
  server.set_read_timeout(kTimeoutSeconds);
  server.set_write_timeout(kTimeoutSeconds);
  server.set_keep_alive_max_count(1);  // a thread serves one connection at a time
  server.set_payload_max_length(0);
  server.Get("/metrics", [&metrics](const httplib::Request&, httplib::Response& response) {
    const prometheus::TextSerializer serializer;
    response.set_content(serializer.prometheus::Serializer::Serialize(metrics.collect()),
                         "text/plain; version=0.0.4; charset=utf-8");
  });
  const bool any = place->port == 0;
  const bool bound = any ? (self->port_ = server.bind_to_any_port(place->host)) > 0
                         : server.bind_to_port(place->host, self->port_ = place->port);
  if (!bound)
    return absl::UnavailableError(absl::StrCat("metrics: cannot listen on ", address, "; is the port taken?"));
  self->http_->thread = std::thread([&server] { server.listen_after_bind(); });
  // The server cannot be stopped before it runs.
  while (!server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return self;
}

}  // namespace lipofill::server
