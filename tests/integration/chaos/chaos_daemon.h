#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/integration/service/daemon_process.h"

namespace lipofill::testing {

/// A daemon that dies and is started again on the same data, each time on another port, while
/// clients go on calling.
class ChaosDaemon {
 public:
  ChaosDaemon(std::string data, std::vector<std::string> arguments);

  /// SIGKILL, then a new one that serves; `meanwhile` is called between.
  void kill_and_restart(const std::function<void()>& meanwhile = [] {});
  /// The same, with one between that is killed so soon after its start that it may not have come to
  /// serve.
  void kill_twice_and_restart(std::chrono::milliseconds lifetime);

  std::shared_ptr<grpc::Channel> channel() const;
  // Of the one that lives, for whoever kills and starts it.
  pid_t pid() const { return process_->pid(); }
  int port() const;
  bool lives() const { return process_->wait(0.001) == -1 && process_->running(); }
  const std::string& data() const { return data_; }

 private:
  void start();

  const std::string data_;
  const std::vector<std::string> arguments_;
  std::unique_ptr<DaemonProcess> process_;
  mutable std::mutex mutex_;
  std::shared_ptr<grpc::Channel> channel_;
};

/// Whether a call was not answered: the daemon died, or is not there yet; or was not carried out,
/// for want of room, memory or descriptors.
inline bool is_unanswered(const grpc::Status& status) {
  return status.error_code() == grpc::StatusCode::UNAVAILABLE ||
         status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED ||
         status.error_code() == grpc::StatusCode::UNKNOWN ||
         status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED;
}

/// Calls again and again, with the same request, until there is an answer.
template <typename Service, typename Method, typename Request, typename Response>
grpc::Status ask_until_answered(const ChaosDaemon& daemon, Method method, const Request& request, Response& response) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(3);
  while (true) {
    const auto stub = Service::NewStub(daemon.channel());
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    response = Response();
    const grpc::Status status = (stub.get()->*method)(&context, request, &response);
    if (!is_unanswered(status) || std::chrono::steady_clock::now() > give_up) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
}

}  // namespace lipofill::testing
