#include "tests/integration/service/spectator.h"

#include <utility>

namespace lipofill::testing {
namespace {

std::shared_ptr<grpc::Channel> connect(const std::string& server) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(server, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

Spectator::Spectator(const std::string& server, const v1::WatchRequest& request)
    : request_(request), channel_(connect(server)), watcher_(*channel_, request) {}

Spectator::~Spectator() {
  watcher_.cancel();
  if (thread_.joinable()) thread_.join();
}

bool Spectator::next() {
  SeenFrame frame;
  if (!watcher_.next(frame)) return false;
  frame_ = std::move(frame);
  return true;
}

grpc::Status Spectator::acknowledge() {
  v1::AcknowledgeFrameRequest request;
  request.set_simulation(request_.simulation());
  request.set_viewer(request_.viewer());
  request.set_epoch(frame_.slice.epoch());
  request.set_sequence(frame_.slice.sequence());
  v1::AcknowledgeFrameResponse response;
  const auto stub = v1::FrameService::NewStub(channel_);
  return call(*stub, &v1::FrameService::Stub::AcknowledgeFrame, request, response);
}

void Spectator::run(std::function<void(Spectator&)> act) {
  thread_ = std::thread([this, act = std::move(act)] { act(*this); });
}

}  // namespace lipofill::testing
