#pragma once

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/server_context.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "server/ops/logging.h"
#include "server/security/principal.h"

namespace lipofill::server {

class CallGate;

/// Everything the daemon knows of a call: at first its metadata, then also the resources its
/// request names.
struct Call {
  std::string method;      ///< "/lipofill.v1.PatientService/GetPatient"
  std::string request_id;  ///< the client's x-request-id, or one that was made for it
  std::string trace_id;    ///< the client's W3C traceparent has it; empty without one
  std::string parent_id;   ///< the client's span, the same way
  Principal principal;     ///< who calls, once admitted
  /// The reason why the call is not to be carried out; whatever answers calls looks here first. A
  /// call that nobody has looked at is refused.
  absl::Status refusal = absl::PermissionDeniedError("the call was not admitted");
  CallGate* gate = nullptr;
  uint64_t number = 0;                      ///< among the live calls
  std::vector<std::string> resources = {};  ///< that its request names, once it was checked
  std::string made = {};                    ///< the name of what it made
  bool begun = false;                       ///< the audit log has it

  /// The fields that lines of the log say of the call.
  LogFields log_fields() const;
};

using Metadata = std::multimap<grpc::string_ref, grpc::string_ref>;

/// Reads x-request-id (1 to 64 letters, digits, '.', '_', ':' and '-', else one is made) and
/// traceparent (version 00, else ignored). Checked by tests/unit/server/entry/call_test.cc.
Call read_call(const std::string& method, const Metadata& metadata);

/// The context of a call with what is known of it. Every call of a service of ours has one: see
/// CallContextAllocator.
class CallContext : public grpc::CallbackServerContext {
 public:
  /// The call is shared with its watcher, which outlasts the context by a moment.
  const std::shared_ptr<Call> call = std::make_shared<Call>();
};

/// Returns the Call that belongs to the context.
Call& call_of(grpc::CallbackServerContext* context);

/// gRPC returns all contexts through the base class, no matter who made them, also those of generic
/// calls to methods that do not exist: so all contexts must be made here.
class CallContextAllocator : public grpc::ContextAllocator {
 public:
  grpc::CallbackServerContext* NewCallbackServerContext() override { return new CallContext; }
  grpc::GenericCallbackServerContext* NewGenericCallbackServerContext() override {
    return new grpc::GenericCallbackServerContext;
  }
  void Release(grpc::CallbackServerContext* context) override { delete context; }
  void Release(grpc::GenericCallbackServerContext* context) override { delete context; }
};

}  // namespace lipofill::server
