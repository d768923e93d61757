#include "tests/integration/chaos/chaos_daemon.h"

#include <utility>

namespace lipofill::testing {

ChaosDaemon::ChaosDaemon(std::string data, std::vector<std::string> arguments)
    : data_(std::move(data)), arguments_(std::move(arguments)) {
  start();
}

void ChaosDaemon::start() {
  process_ = std::make_unique<DaemonProcess>(data_, arguments_);
  auto channel = grpc::CreateChannel(process_->address(), grpc::InsecureChannelCredentials());
  const std::lock_guard lock(mutex_);
  channel_ = std::move(channel);
}

void ChaosDaemon::kill_and_restart(const std::function<void()>& meanwhile) {
  process_->kill_hard();
  meanwhile();
  start();
}

void ChaosDaemon::kill_twice_and_restart(std::chrono::milliseconds lifetime) {
  process_->kill_hard();
  DaemonProcess::start_and_kill(data_, arguments_, lifetime);
  start();
}

int ChaosDaemon::port() const {
  const std::string address = process_->address();
  return std::stoi(address.substr(address.find(':') + 1));
}

std::shared_ptr<grpc::Channel> ChaosDaemon::channel() const {
  const std::lock_guard lock(mutex_);
  return channel_;
}

}  // namespace lipofill::testing
