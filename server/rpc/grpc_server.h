#pragma once

#include <grpcpp/server.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/rpc/backend.h"
#include "server/rpc/frame_service.h"
#include "server/rpc/operation_service.h"
#include "server/rpc/patient_service.h"
#include "server/rpc/simulation_service.h"

namespace lipofill::server {

/// The services on a TCP port, with standard health and reflection.
class GrpcServer {
 public:
  /// @param address  host:port; port 0 takes a free one
  /// UNAVAILABLE when the address cannot be listened on, also when another program already does.
  static absl::StatusOr<std::unique_ptr<GrpcServer>> start(const std::string& address, Backend& backend);

  int port() const { return port_; }

  /// In order: no new work, viewers' streams end with UNAVAILABLE, simulations stand still with their state kept, for
  /// the next start to go on from, builds are cancelled, calls under way are answered or cut off.
  void stop();

 private:
  explicit GrpcServer(Backend& backend);

  Backend& backend_;
  PatientService patients_;
  OperationService operations_;
  SimulationService simulations_;
  FrameService frames_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

}  // namespace lipofill::server
