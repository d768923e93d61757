#pragma once

#include <grpcpp/support/server_callback.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/entry/unary.h"

namespace lipofill::server {

/// Sends messages that were made beforehand one after the other, as long as the caller is known and
/// takes them. What they take is counted (LiveCalls), and let go of as they are sent. It deletes
/// itself once gRPC is done with it.
/// Checked by tests/integration/service/shape_test.cc and the tests of downloads.
template <typename Message>
class PreparedStream : public grpc::ServerWriteReactor<Message> {
 public:
  explicit PreparedStream(grpc::CallbackServerContext* context) : context_(context) {}

  /// @param messages  at least one
  void send(std::vector<Message> messages) {
    uint64_t bytes = 0;
    for (const Message& message : messages) bytes += message.ByteSizeLong();
    if (const absl::Status room = keep_answers(context_, bytes); !room.ok()) return fail(room);
    messages_ = std::move(messages);
    this->StartWrite(&messages_[0]);
  }
  void fail(const absl::Status& status) { this->Finish(to_grpc_status(status)); }

  void OnWriteDone(bool ok) override {
    if (!ok) return fail(absl::CancelledError("the client has gone"));
    if (++sent_ == messages_.size()) return this->Finish(grpc::Status::OK);
    if (const absl::Status known = check_still_known(context_); !known.ok()) return fail(known);
    this->StartWrite(&messages_[sent_]);
  }
  void OnDone() override { delete this; }

 private:
  grpc::CallbackServerContext* const context_;
  std::vector<Message> messages_;
  size_t sent_ = 0;
};

}  // namespace lipofill::server
