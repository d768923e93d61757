#include "server/rpc/grpc_server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

constexpr auto kShutdownGrace = std::chrono::milliseconds(500);

int to_milliseconds(double seconds) {
  return static_cast<int>(std::lround(1e3 * seconds));
}

/// A peer that has frozen or lost its network is found by pings, or, when bytes wait for it, by TCP's own probes; one
/// that pings us more than every ten seconds is turned away.
void set_channel_arguments(const BackendOptions& options, grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, to_milliseconds(options.keepalive_s));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, to_milliseconds(options.keepalive_timeout_s));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 256);
}

}  // namespace

GrpcServer::GrpcServer(Backend& backend)
    : backend_(backend), patients_(backend), operations_(backend), simulations_(backend), frames_(backend) {}

absl::StatusOr<std::unique_ptr<GrpcServer>> GrpcServer::start(const std::string& address, Backend& backend) {
  grpc::EnableDefaultHealthCheckService(true);
  // Named, so that the linker keeps the library.
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  std::unique_ptr<GrpcServer> self(new GrpcServer(backend));
  grpc::ServerBuilder builder;
  set_channel_arguments(backend.options, builder);
  builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &self->port_);
  builder.RegisterService(&self->patients_);
  builder.RegisterService(&self->operations_);
  builder.RegisterService(&self->simulations_);
  builder.RegisterService(&self->frames_);
  self->server_ = builder.BuildAndStart();
  if (self->server_ == nullptr || self->port_ == 0) {
    return absl::UnavailableError(absl::StrCat("cannot listen on ", address, "; is the port taken?"));
  }
  return self;
}

void GrpcServer::stop() {
  backend_.stopping = true;
  server_->GetHealthCheckService()->SetServingStatus(false);
  backend_.sessions.suspend_all("the daemon stopped");
  backend_.operations.stop();
  server_->Shutdown(std::chrono::system_clock::now() + kShutdownGrace);
  backend_.builds.stop();
  backend_.calls.stop();
  server_->Wait();
  backend_.workers.stop();
}

}  // namespace lipofill::server
