#include "server/grpc_server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/server_builder_plugin.h>
#include <grpcpp/server_builder.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/synchronization/mutex.h"
#include "server/entry/call_watcher.h"
#include "server/entry/tls_credentials.h"
#include "server/sessions/draining.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// Share of the time to drain that calls under way may take; the rest is for work that was begun.
constexpr double kShareForCalls = 0.25;
constexpr GrpcServer::Seconds kMaxForCalls{5.0};
constexpr GrpcServer::Seconds kToCutOff{1.0};

int to_milliseconds(double seconds) {
  return static_cast<int>(std::lround(1e3 * seconds));
}

/// A peer that has frozen or lost its network is found by pings, or, when bytes wait for it, by
/// TCP's own probes; one that pings us more than every ten seconds is turned away.
void set_channel_arguments(const BackendOptions& options, grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, to_milliseconds(options.keepalive_s));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, to_milliseconds(options.keepalive_timeout_s));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 256);
}

void watch_calls(grpc::ServerBuilder& builder, Metrics& metrics, CallGate& gate) {
  builder.SetContextAllocator(std::make_unique<CallContextAllocator>());
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> watchers;
  watchers.push_back(std::make_unique<CallWatchers>(metrics, gate));
  builder.experimental().SetInterceptorCreators(std::move(watchers));
}

/// Reflection comes by a plugin that is there as soon as its library is linked.
class WithoutReflection : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments*) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    std::erase_if(*plugins, [](const auto& plugin) { return plugin->name() == "proto_server_reflection"; });
  }
};

bool is_unix(const std::string& address) {
  return absl::StartsWith(address, "unix:");
}

absl::Status cannot_listen(const std::string& address) {
  return absl::UnavailableError(
      absl::StrCat("cannot listen on ", address,
                   is_unix(address) ? ": may this user make files in its directory?" : ": is the port taken?"));
}

/// Restricts UNIX sockets to the daemon's user and group.
void restrict_sockets(const std::vector<std::string>& addresses) {
  for (const std::string& address : addresses) {
    if (!is_unix(address)) continue;
    const std::string rest = address.substr(5);
    ::chmod((absl::StartsWith(rest, "//") ? rest.substr(2) : rest).c_str(), 0660);
  }
}

}  // namespace

GrpcServer::GrpcServer(const ServiceGuard& guard, Backend& backend)
    : backend_(backend),
      gate_(backend, guard.authenticator, guard.audit),
      patients_(backend),
      operations_(backend),
      simulations_(backend),
      frames_(backend) {}

absl::StatusOr<std::unique_ptr<GrpcServer>> GrpcServer::start(const std::vector<std::string>& addresses,
                                                              const ServiceGuard& guard, Backend& backend) {
  // Debian builds absl, on whose mutexes gRPC runs, with its search for deadlocks, which takes part
  // in every lock.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  grpc::EnableDefaultHealthCheckService(true);
  // The library is named here so that the linker takes it in.
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  std::unique_ptr<GrpcServer> self(new GrpcServer(guard, backend));
  grpc::ServerBuilder builder;
  set_channel_arguments(backend.options, builder);
  watch_calls(builder, backend.metrics, self->gate_);
  if (!guard.reflection) builder.SetOption(std::make_unique<WithoutReflection>());
  const auto plain = grpc::InsecureServerCredentials();
  const auto on_tcp = guard.settings.has_tls() ? make_tls_credentials(guard.settings) : plain;
  std::vector<int> ports(addresses.size());
  for (size_t i = 0; i < addresses.size(); ++i) {
    builder.AddListeningPort(addresses[i], is_unix(addresses[i]) ? plain : on_tcp, &ports[i]);
  }
  builder.RegisterService(&self->patients_);
  builder.RegisterService(&self->operations_);
  builder.RegisterService(&self->simulations_);
  builder.RegisterService(&self->frames_);
  self->server_ = builder.BuildAndStart();
  const auto failed = std::find(ports.begin(), ports.end(), 0);
  if (failed != ports.end()) return cannot_listen(addresses[failed - ports.begin()]);
  if (self->server_ == nullptr) return cannot_listen(absl::StrJoin(addresses, ", "));
  restrict_sockets(addresses);
  for (size_t i = addresses.size(); i-- > 0;) {
    if (!is_unix(addresses[i])) self->port_ = ports[i];
  }
  return self;
}

bool GrpcServer::drain(Seconds delay, Seconds timeout) {
  server_->GetHealthCheckService()->SetServingStatus(false);
  backend_.stopping = true;
  std::this_thread::sleep_for(delay);
  backend_.sessions.suspend_all();
  spdlog::info("simulations are at rest");
  backend_.operations.stop();
  const Seconds for_calls = std::min(kMaxForCalls, kShareForCalls * (timeout - delay));
  const std::future<void> calls_ended = end_calls(for_calls);
  backend_.builds.stop();
  backend_.calls.stop();
  backend_.workers.stop();
  if (calls_ended.wait_for(for_calls + kToCutOff) == std::future_status::ready) return true;
  spdlog::warn("clients that neither read nor leave are cut off");
  return false;
}

// Shutdown() may never return: data that a frozen peer does not take from its socket cannot be
// cancelled.
std::future<void> GrpcServer::end_calls(Seconds grace) {
  const auto deadline = std::chrono::system_clock::now() + std::chrono::duration_cast<std::chrono::milliseconds>(grace);
  auto done = std::make_shared<std::promise<void>>();
  std::thread([this, deadline, done] {
    server_->Shutdown(deadline);
    done->set_value();
  }).detach();
  return done->get_future();
}

}  // namespace lipofill::server
