#include "tests/integration/security/caller.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/util/json_util.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "lipofill/v1/forecast_service.pb.h"
#include "lipofill/v1/plan_service.pb.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::testing {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::Message;

std::unique_ptr<Message> make_request(const std::string& method, const std::string& json) {
  v1::MakeTargetRequest::descriptor();  // no stub here makes the linker take the services' files
  v1::MakeForecastRequest::descriptor();
  v1::CreatePlanRequest::descriptor();
  const std::string full = full_name(method);
  const size_t slash = full.rfind('/');
  const auto* service = DescriptorPool::generated_pool()->FindServiceByName(full.substr(1, slash - 1));
  const auto* found = service == nullptr ? nullptr : service->FindMethodByName(full.substr(slash + 1));
  if (found == nullptr) return nullptr;
  std::unique_ptr<Message> request(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(found->input_type())->New());
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(json, request.get()).ok()) << method << " " << json;
  return request;
}

/// Steps of one asynchronous call.
class Steps {
 public:
  /// Whether the step was done.
  bool wait() {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  }
  grpc::CompletionQueue queue;
};

}  // namespace

std::string Answer::reason() const {
  google::rpc::Status wire;
  wire.ParseFromString(status.error_details());
  for (const auto& detail : wire.details()) {
    google::rpc::ErrorInfo info;
    if (detail.UnpackTo(&info)) return info.reason();
  }
  return "";
}

std::string full_name(const std::string& method) {
  return method[0] == '/' ? method : absl::StrCat("/lipofill.v1.", method);
}

std::unique_ptr<grpc::ClientContext> Caller::context() const {
  auto context = std::make_unique<grpc::ClientContext>();
  context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
  if (!token_.empty()) context->AddMetadata("authorization", absl::StrCat("Bearer ", token_));
  return context;
}

Answer Caller::call(const std::string& method, const Message& request) const {
  return call_bytes(method, request.SerializeAsString());
}

Answer Caller::call_json(const std::string& method, const std::string& request) const {
  const auto message = make_request(method, request);
  EXPECT_TRUE(message != nullptr) << "there is no method " << method;
  return message == nullptr ? Answer{grpc::Status(grpc::StatusCode::UNKNOWN, ""), {}} : call(method, *message);
}

Answer Caller::call_bytes(const std::string& method, const std::string& request) const {
  grpc::GenericStub stub(channel_);
  const auto with_token = context();
  Steps steps;
  auto stream = stub.PrepareCall(with_token.get(), full_name(method), &steps.queue);
  stream->StartCall(nullptr);
  steps.wait();
  const grpc::Slice slice(request);
  stream->WriteLast(grpc::ByteBuffer(&slice, 1), grpc::WriteOptions(), nullptr);
  steps.wait();
  Answer answer;
  grpc::ByteBuffer message;
  for (stream->Read(&message, nullptr); steps.wait(); stream->Read(&message, nullptr)) {
    grpc::Slice whole;
    EXPECT_TRUE(message.DumpToSingleSlice(&whole).ok());
    answer.messages.emplace_back(reinterpret_cast<const char*>(whole.begin()), whole.size());
  }
  stream->Finish(&answer.status, nullptr);
  steps.wait();
  return answer;
}

}  // namespace lipofill::testing
