#include "client/cpp/connection.h"

#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "client/cpp/errors.h"
#include "google/rpc/status.pb.h"

namespace lipofill::client {
namespace {

grpc::ChannelArguments channel_arguments() {
  grpc::ChannelArguments arguments;
  // A stalled or frozen daemon is seen only through keepalive.
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 60'000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20'000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2'000);
  // A daemon of this machine is never behind a proxy.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return arguments;
}

}  // namespace

std::string default_server() {
  const char* server = std::getenv("LIPOFILL_SERVER");
  return server != nullptr && *server != '\0' ? server : kDefaultServer;
}

absl::Status status_of(const grpc::Status& status, const std::string& server) {
  if (status.ok()) return absl::OkStatus();
  google::rpc::Status wire;
  if (!wire.ParseFromString(status.error_details()) || wire.details_size() == 0) wire.Clear();
  wire.set_code(static_cast<int>(status.error_code()));
  wire.set_message(status.error_message());
  const bool from_daemon = wire.details_size() > 0;  // it answers, and says why it does not do it
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && !from_daemon) {
    wire.set_message(absl::StrCat("no daemon answers at ", server, "; start lipofilld or use --spawn (",
                                  status.error_message(), ")"));
  } else if (status.error_code() == grpc::StatusCode::UNAUTHENTICATED) {
    wire.set_message(absl::StrCat("the daemon at ", server, " does not know who calls: ", status.error_message(),
                                  ". Give a token (--token-file or LIPOFILL_TOKEN_FILE) or a client certificate ",
                                  "(--tls-cert and --tls-key), or a new one"));
  } else if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED) {
    wire.set_message(absl::StrCat("the daemon at ", server, " did not answer in time"));
  }
  return status_of(wire);
}

Connection::Connection(std::string server, std::stop_token stop, const Credentials& credentials)
    : server_(std::move(server)),
      stop_(std::move(stop)),
      channel_(open_channel(server_, credentials, channel_arguments())) {}

Connection Connection::without_stop() const {
  Connection copy = *this;
  copy.stop_ = {};
  return copy;
}

}  // namespace lipofill::client
