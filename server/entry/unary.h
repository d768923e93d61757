#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <cstdint>
#include <functional>
#include <utility>

#include "absl/status/status.h"
#include "core/base/unwanted.h"
#include "server/backend/backend.h"
#include "server/backend/guarded.h"
#include "server/entry/call.h"
#include "server/entry/call_gate.h"
#include "server/security/refusals.h"
#include "server/sessions/shortage.h"
#include "server/wire/message_check.h"
#include "server/wire/status_mapping.h"

namespace lipofill::server {

/// True once whoever called has cancelled, has gone, or has a deadline that has passed. Until the
/// call was answered.
inline Unwanted caller_has_left(grpc::CallbackServerContext* context) {
  return [context] { return context->IsCancelled(); };
}

/// Checks whether a call is to be carried out with this request: it is admitted, its message is one
/// this schema knows, and everything it names is the caller's. Every method begins with it.
template <typename Request>
absl::Status check_call(grpc::CallbackServerContext* context, const Request& request) {
  Call& call = call_of(context);
  if (call.gate == nullptr) return call.refusal;
  if (const absl::Status admitted = call.gate->check_admitted(call, request); !admitted.ok()) return admitted;
  if (const absl::Status room = call.gate->live_calls().keep_request(call.number, request.SpaceUsedLong());
      !room.ok()) {
    return room;
  }
  if (const absl::Status known = check_message(request); !known.ok()) return known;
  return call.gate->check(call, request);
}

/// Checks a call that goes on for a while: UNAUTHENTICATED once the caller's token has expired.
inline absl::Status check_still_known(grpc::CallbackServerContext* context) {
  return call_of(context).principal.has_expired() ? token_expired() : absl::OkStatus();
}

/// Counts answers of a stream that are made before the first is sent: RESOURCE_EXHAUSTED without
/// room for them.
inline absl::Status keep_answers(grpc::CallbackServerContext* context, uint64_t bytes) {
  const Call& call = call_of(context);
  return call.gate == nullptr ? call.refusal : call.gate->live_calls().keep_answers(call.number, bytes);
}

/// Answers a call at once. `work` fills the response and returns a status.
template <typename Request, typename Work>
grpc::ServerUnaryReactor* answer(grpc::CallbackServerContext* context, const Request* request, Work&& work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const LogScope scope(call_of(context).log_fields());
  const absl::Status valid = check_call(context, *request);
  reactor->Finish(to_grpc_status(valid.ok() ? guarded(work) : valid));
  return reactor;
}

/// Answers a call at once, or leaves that to somebody: `work` is given the reactor, and a flag that
/// it sets before it hands that on. It looks for what the request names only here, once the call
/// was checked, so that what is another's is not looked for longer than what is absent.
template <typename Request, typename Work>
grpc::ServerUnaryReactor* answer_or_leave(grpc::CallbackServerContext* context, const Request* request, Work&& work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const LogScope scope(call_of(context).log_fields());
  bool is_left = false;
  absl::Status done = check_call(context, *request);
  if (done.ok()) done = guarded([&] { return work(reactor, is_left); });
  if (!is_left) reactor->Finish(to_grpc_status(done));
  return reactor;
}

/// Refuses a long call when too many wait already.
inline absl::Status too_many_calls(const Backend& backend) {
  constexpr double retry_delay_s = 2.0;
  return shortage("TOO_MANY_CALLS", retry_delay_s,
                  "too many long calls are waiting, the bound is " + std::to_string(backend.calls.max_queued()));
}

/// Answers a call from the pool for long calls. One whose caller has left by then is not begun.
template <typename Request>
grpc::ServerUnaryReactor* answer_later(grpc::CallbackServerContext* context, const Request* request, Backend& backend,
                                       std::function<absl::Status()> work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  if (const absl::Status valid = check_call(context, *request); !valid.ok()) {
    reactor->Finish(to_grpc_status(valid));
    return reactor;
  }
  const bool taken =
      backend.calls.run([context, reactor, work = std::move(work), fields = call_of(context).log_fields()] {
        const LogScope scope(fields);
        reactor->Finish(to_grpc_status(guarded_if_wanted(caller_has_left(context), work)));
      });
  if (!taken) {
    reactor->Finish(to_grpc_status(too_many_calls(backend)));
  }
  return reactor;
}

}  // namespace lipofill::server
