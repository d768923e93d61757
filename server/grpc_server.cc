#include "server/grpc_server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/server_builder_plugin.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "absl/synchronization/mutex.h"
#include "server/entry/call_watcher.h"
#include "server/entry/tls_credentials.h"
#include "server/ops/listen_address.h"
#include "server/sessions/draining.h"
#include "server/sessions/memory_reserve.h"
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

/// All that connections have sent and nobody has taken yet.
constexpr size_t kTransportBytes = size_t{512} << 20;
/// A connection without a call is closed after so long; its client makes another when it calls.
constexpr int kMaxIdleMs = 600'000;

/// A peer that has frozen or lost its network is found by pings, or, when bytes wait for it, by
/// TCP's own probes (DoorBounds::unread); one that pings us more than every ten seconds is turned
/// away. Headers may have what the door lets by: those that exceed gRPC's bound may end the
/// connection, which where a front shares it is not their sender's alone.
void set_channel_arguments(const BackendOptions& options, grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, to_milliseconds(options.keepalive_s));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, to_milliseconds(options.keepalive_timeout_s));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 256);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, static_cast<int>(FrameMeter::kMostHeaderBytes));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kMaxIdleMs);
  builder.SetResourceQuota(grpc::ResourceQuota("transport").Resize(kTransportBytes));
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

}  // namespace

GrpcServer::GrpcServer(const ServiceGuard& guard, const DoorBounds& bounds, Backend& backend)
    : backend_(backend), gate_(backend, guard.authenticator, guard.audit), services_(backend), door_(bounds) {}

GrpcServer::~GrpcServer() {
  sweeper_.reset();
  door_.close();  // before what it hands connections to
}

absl::StatusOr<std::unique_ptr<GrpcServer>> GrpcServer::start(const std::vector<std::string>& addresses,
                                                              const ServiceGuard& guard, const DoorBounds& bounds,
                                                              Backend& backend) {
  // Debian builds absl, on whose mutexes gRPC runs, with its search for deadlocks, which takes part
  // in every lock.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  MemoryReserve::set_up();
  grpc::EnableDefaultHealthCheckService(true);
  // The library is named here so that the linker takes it in.
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  std::unique_ptr<GrpcServer> self(new GrpcServer(guard, bounds, backend));
  if (auto listens = self->listen(addresses, guard.settings.has_tls()); !listens.ok()) return listens;
  grpc::ServerBuilder builder;
  set_channel_arguments(backend.options, builder);
  watch_calls(builder, backend.metrics, self->gate_);
  if (!guard.reflection) builder.SetOption(std::make_unique<WithoutReflection>());
  using From = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
  self->plain_ = builder.experimental().AddExternalConnectionAcceptor(From::FROM_FD, grpc::InsecureServerCredentials());
  if (guard.settings.has_tls()) {
    self->encrypted_ =
        builder.experimental().AddExternalConnectionAcceptor(From::FROM_FD, make_tls_credentials(guard.settings));
  }
  builder.RegisterService(&self->services_.patients);
  builder.RegisterService(&self->services_.operations);
  builder.RegisterService(&self->services_.simulations);
  builder.RegisterService(&self->services_.frames);
  builder.RegisterService(&self->services_.planning);
  builder.RegisterService(&self->services_.plans);
  builder.RegisterService(&self->services_.forecasts);
  self->server_ = builder.BuildAndStart();
  if (self->server_ == nullptr) return absl::InternalError("gRPC does not start; its own log says why");
  if (auto opened = self->open_door(); !opened.ok()) return opened;
  self->sweeper_ = std::make_unique<Periodic>("sweeper", std::chrono::seconds(1), [gate = &self->gate_, &backend] {
    gate->sweep();
    MemoryReserve::refill();
    backend.shapes.drop_idle();
  });
  return self;
}

absl::Status GrpcServer::listen(const std::vector<std::string>& addresses, bool is_encrypted) {
  for (const std::string& text : addresses) {
    const auto address = parse_listen_address(text);
    if (!address.ok()) return address.status();
    if (address->is_unix()) {
      auto claim = SocketClaim::take(address->unix_path);
      if (!claim.ok()) return claim.status();
      claims_.push_back(*std::move(claim));
    }
    auto sockets = address->is_unix() ? listen_on_path(address->unix_path) : listen_on(address->host, address->port);
    if (!sockets.ok()) return sockets.status();
    if (port_ == 0) port_ = sockets->front().port;
    for (ListeningSocket& socket : *sockets) {
      listeners_.push_back({is_encrypted && !address->is_unix(), own_address(socket)});
      door_.add(std::move(socket), listeners_.back().is_encrypted);
    }
  }
  return absl::OkStatus();
}

absl::Status GrpcServer::open_door() {
  return door_.open([this](int socket, size_t listener) {
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
    connection.fd = socket;
    (listeners_[listener].is_encrypted ? encrypted_ : plain_)->HandleNewConnection(&connection);
  });
}

// The kernel completes a connection before it is accepted: without an answer to wait for, the
// door's count says whether it was.
absl::Status GrpcServer::check_reachable() const {
  constexpr std::chrono::seconds kTimeout{5};
  for (const Listener& listener : listeners_) {
    const uint64_t before = door_.figures().accepted;
    if (auto reached = knock(listener.own, !listener.is_encrypted, kTimeout); !reached.ok()) return reached;
    const auto end = std::chrono::steady_clock::now() + kTimeout;
    while (door_.figures().accepted == before) {
      if (std::chrono::steady_clock::now() > end) return absl::UnavailableError("a connection to it is not accepted");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  return absl::OkStatus();
}

void GrpcServer::set_reachable(bool reachable) {
  const std::lock_guard lock(health_mutex_);
  if (!backend_.stopping) server_->GetHealthCheckService()->SetServingStatus(reachable);
}

bool GrpcServer::drain(Seconds delay, Seconds timeout) {
  {
    const std::lock_guard lock(health_mutex_);
    server_->GetHealthCheckService()->SetServingStatus(false);
    backend_.stopping = true;
  }
  std::this_thread::sleep_for(delay);
  backend_.sessions.suspend_all();
  spdlog::info("simulations are at rest");
  backend_.operations.stop();
  backend_.shapes.close();
  const Seconds for_calls = std::min(kMaxForCalls, kShareForCalls * (timeout - delay));
  const std::future<void> calls_ended = end_calls(for_calls);
  backend_.builds.stop();
  backend_.calls.stop();
  backend_.workers.stop();
  if (calls_ended.wait_for(for_calls + kToCutOff) == std::future_status::ready) return true;
  spdlog::warn("clients that neither read nor leave are cut off");
  door_.close();
  return calls_ended.wait_for(kToCutOff) == std::future_status::ready;
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
