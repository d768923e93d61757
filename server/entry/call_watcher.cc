#include "server/entry/call_watcher.h"

#include <google/protobuf/message.h>
#include <grpcpp/support/byte_buffer.h>

#include <chrono>
#include <memory>

#include "absl/strings/match.h"
#include "server/entry/method_rules.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::InterceptorBatchMethods;
using Clock = std::chrono::steady_clock;

constexpr char kWatch[] = "/lipofill.v1.FrameService/Watch";

/// Clients can send names of methods that do not exist; these have no place in metrics and logs.
std::string name_of(const std::string& method) {
  return has_rule(method) ? method : "unknown";
}

/// One call, from its metadata to its status. gRPC owns it as long as the call's context.
class CallWatcher : public grpc::experimental::Interceptor {
 public:
  CallWatcher(grpc::experimental::ServerRpcInfo& info, Metrics& metrics, CallGate& gate)
      : method_(name_of(info.method())),
        context_(*info.server_context()),
        call_(shared_call(context_)),
        metrics_(metrics),
        counts_(metrics.calls().of_method(method_)),
        gate_(gate) {
    call_->method = method_;
    counts_.started.Increment();
    counts_.in_flight.Increment();
  }

  ~CallWatcher() override {
    if (number_ != 0) gate_.live_calls().remove(number_);
    if (!ended_) end(absl::StatusCode::kCancelled);
  }

  void Intercept(InterceptorBatchMethods* batch) override {
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_INITIAL_METADATA)) {
      begin(*batch->GetRecvInitialMetadata());
    }
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
      batch->GetSendInitialMetadata()->emplace("x-request-id", call_->request_id);
    }
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_MESSAGE)) {
      const void* answer = batch->GetSendMessage();
      const grpc::ByteBuffer* message = batch->GetSerializedSendMessage();
      if (answer != nullptr && sends_messages_) let_go_of_content(answer);
      if (message != nullptr) note_sent(*message);
    }
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::POST_SEND_MESSAGE)) {
      gate_.live_calls().end_answer(number_);
    }
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
      end(static_cast<absl::StatusCode>(batch->GetSendStatus().error_code()));
    }
    batch->Proceed();
  }

 private:
  static std::shared_ptr<Call> shared_call(grpc::ServerContextBase& context) {
    const auto* ours = dynamic_cast<CallContext*>(&context);
    return ours != nullptr ? ours->call : std::make_shared<Call>();
  }

  void begin(const Metadata& metadata) {
    *call_ = read_call(method_, metadata);
    call_->gate = &gate_;
    call_->refusal = gate_.admit(*call_, metadata, context_);
    number_ = gate_.live_calls().add(context_.c_call(), call_->principal, is_watch_);
    call_->number = number_;
    call_->refusal.Update(gate_.live_calls().check_number_of_calls(number_));
  }

  void note_sent(const grpc::ByteBuffer& message) {
    counts_.sent_bytes.Increment(static_cast<double>(message.Length()));
    gate_.note_answer(*call_, message);
    gate_.live_calls().begin_answer(number_, message.Length()).IgnoreError();
  }

  /// Its bytes are made, and nobody looks at it again: gRPC would keep it, which takes some four
  /// times as much as they do, until the caller has read them.
  static void let_go_of_content(const void* answer) {
    auto& message = *static_cast<google::protobuf::Message*>(const_cast<void*>(answer));
    const std::unique_ptr<google::protobuf::Message> content(message.New());
    message.GetReflection()->Swap(&message, content.get());
  }

  void end(absl::StatusCode code) {
    ended_ = true;
    const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
    const std::string code_name = absl::StatusCodeToString(code);
    counts_.in_flight.Decrement();
    counts_.seconds.Observe(seconds);
    metrics_.calls().count_handled(method_, code_name);
    LogFields fields = {{"method", method_}, {"code", code_name}, {"duration_ms", seconds * 1e3}};
    const LogFields of_call = call_->log_fields();
    fields.insert(fields.end(), of_call.begin(), of_call.end());
    const LogScope scope(std::move(fields));
    // Health is asked for often, so it is logged at debug level.
    spdlog::log(absl::StartsWith(method_, "/grpc.") ? spdlog::level::debug : spdlog::level::info, "call");
    gate_.note_end(*call_, code_name);
  }

  const std::string method_;
  grpc::ServerContextBase& context_;
  const std::shared_ptr<Call> call_;
  Metrics& metrics_;
  const MethodMetrics counts_;
  CallGate& gate_;
  const Clock::time_point began_ = Clock::now();
  const bool is_watch_ = method_ == kWatch;
  /// Our own services answer with messages, but for Watch, which sends bytes.
  const bool sends_messages_ = !is_watch_ && absl::StartsWith(method_, "/lipofill.");
  uint64_t number_ = 0;  ///< among the live calls
  bool ended_ = false;
};

}  // namespace

grpc::experimental::Interceptor* CallWatchers::CreateServerInterceptor(grpc::experimental::ServerRpcInfo* info) {
  return new CallWatcher(*info, metrics_, gate_);
}

}  // namespace lipofill::server
