#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <chrono>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cpp/credentials.h"

namespace lipofill::client {

inline constexpr char kDefaultServer[] = "127.0.0.1:50061";

/// Address from LIPOFILL_SERVER if it is set, else kDefaultServer.
std::string default_server();

/// A gRPC status as a status of this library, with its details; UNAVAILABLE and UNAUTHENTICATED say
/// which daemon was asked and what to do.
absl::Status status_of(const grpc::Status& status, const std::string& server);

/// A daemon to talk to. Calls end with CANCELLED soon after the stop token asks for it.
/// Thread-safe; copies share the channel.
///
///     Connection connection("127.0.0.1:50061");
///     absl::StatusOr<v1::Patient> patient = connection.call<v1::PatientService>(&v1::PatientService::Stub::GetPatient,
///     request);
///
/// Checked by tests/unit/client/errors_test.cc and tests/integration/cli/.
class Connection {
 public:
  explicit Connection(std::string server, std::stop_token stop = {}, const Credentials& credentials = {});

  const std::string& server() const { return server_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
  const std::stop_token& stop() const { return stop_; }

  /// The same daemon, for what must still be said to it once stop was asked for.
  Connection without_stop() const;

  /// Setting up a simulation of a large model takes the daemon minutes.
  static constexpr std::chrono::seconds kCreationTimeout{600};

  /// Sends one request and returns its response. DEADLINE_EXCEEDED after `timeout`.
  template <typename Service, typename Request, typename Response>
  absl::StatusOr<Response> call(grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                                const Request& request, std::chrono::seconds timeout = std::chrono::seconds(60)) const {
    const auto stub = Service::NewStub(channel_);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + timeout);
    std::stop_callback cancel(stop_, [&context] { context.TryCancel(); });
    Response response;
    const absl::Status status = status_of((stub.get()->*method)(&context, request, &response), server_);
    if (!status.ok()) return status;
    return response;
  }

 private:
  std::string server_;
  std::stop_token stop_;
  std::shared_ptr<grpc::Channel> channel_;
};

}  // namespace lipofill::client
