#pragma once

#include <grpcpp/server.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/backend/backend.h"
#include "server/entry/call_gate.h"
#include "server/frames/frame_service.h"
#include "server/patients/operation_service.h"
#include "server/patients/patient_service.h"
#include "server/simulations/simulation_service.h"

namespace lipofill::server {

/// The guards of the services.
struct ServiceGuard {
  const SecuritySettings& settings;
  const Authenticator& authenticator;
  AuditLog* audit = nullptr;  ///< nullptr: nothing is written down
  bool reflection = true;
};

/// The services on TCP ports and UNIX sockets, with standard health and reflection. Every call
/// passes CallWatchers.
class GrpcServer {
 public:
  /// @param addresses  host:port (port 0 takes a free one) or unix:path. Users of the socket's
  ///                   group may write to it.
  /// @param guard      who may do what; outlives the server. TCP is served with TLS where it has
  ///                   that.
  /// UNAVAILABLE when one cannot be listened on, also when another program already does.
  static absl::StatusOr<std::unique_ptr<GrpcServer>> start(const std::vector<std::string>& addresses,
                                                           const ServiceGuard& guard, Backend& backend);

  /// Port of the first address on TCP; 0 when there is none.
  int port() const { return port_; }

  using Seconds = std::chrono::duration<double>;
  /// Ends the service, in order: health turns NOT_SERVING and nothing new is taken; after `delay`
  /// viewers' streams end with draining(), simulations stand still with their state kept, for the
  /// next start to go on from, builds are cancelled, calls under way are answered or, after some
  /// seconds of `timeout`, cut off. Returns when all have ended; within `timeout` but for work that
  /// does not look at the clock (a step, a build). False when gRPC still waits for clients that
  /// neither read nor leave: all work is done, but the program must end without destroying the
  /// server.
  /// Checked by tests/integration/service/drain_test.cc.
  bool drain(Seconds delay, Seconds timeout);

 private:
  GrpcServer(const ServiceGuard& guard, Backend& backend);
  /// Becomes ready when the last call has ended; calls that have not within `grace` are cancelled.
  std::future<void> end_calls(Seconds grace);

  Backend& backend_;
  CallGate gate_;
  PatientService patients_;
  OperationService operations_;
  SimulationService simulations_;
  FrameService frames_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

}  // namespace lipofill::server
