#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>

#include <string>

#include "absl/status/status.h"
#include "server/backend/backend.h"
#include "server/entry/call.h"
#include "server/entry/live_calls.h"
#include "server/security/allowance.h"
#include "server/security/audit_log.h"
#include "server/security/authenticator.h"
#include "server/wire/resource_names.h"

namespace lipofill::server {

/// Checks every call before its method runs, whatever the service: who calls, whether the method is
/// for their role, whether the request names only resources of theirs. It also writes the audit
/// log. A resource of another tenant is answered like one that does not exist, before anything else
/// of the request is looked at, so that no answer tells the two apart. Checked by
/// tests/integration/security/.
class CallGate {
 public:
  /// `audit` may be nullptr: nothing is written down then.
  CallGate(Backend& backend, const Authenticator& authenticator, AuditLog* audit)
      : backend_(backend),
        authenticator_(authenticator),
        audit_(audit),
        live_calls_({.shown = backend.options.viewer_bytes}) {}

  /// Admits a call by its metadata, before there is a request, and fills in who calls.
  /// UNAUTHENTICATED, PERMISSION_DENIED, or draining().
  absl::Status admit(Call& call, const Metadata& metadata, const grpc::ServerContextBase& context);
  /// Returns what admit() returned; when it refused a known caller, notes the resources the request
  /// names.
  absl::Status check_admitted(Call& call, const google::protobuf::Message& request);
  /// Checks the request before the method looks at it; for a stream, every message. Calls that
  /// change something are written to the audit log, durably, before they do: UNAVAILABLE when that
  /// cannot be.
  absl::Status check(Call& call, const google::protobuf::Message& request);
  /// Notes how a call ended. At most a hundred calls a minute by unknown callers are written down,
  /// as they must not fill the medium. All are counted in the metrics.
  void note_end(const Call& call, const std::string& code);
  /// The answer of a call that makes something says how that is called.
  void note_answer(Call& call, const grpc::ByteBuffer& message);

  LiveCalls& live_calls() { return live_calls_; }
  /// Ends calls of callers who were revoked, and answers that nobody reads. To be called about once
  /// a second.
  void sweep();

 private:
  absl::Status admit_by_rule(Call& call, const Metadata& metadata, const grpc::ServerContextBase& context);
  absl::Status check_owner(const Scope& scope, const absl::StatusOr<Owner>& owner, const std::string& name);
  absl::Status check_reach(const Scope& scope, const ResourceNames& names);
  absl::Status begin(Call& call);

  Backend& backend_;
  const Authenticator& authenticator_;
  AuditLog* const audit_;
  LiveCalls live_calls_;
  Allowance strangers_{100, std::chrono::minutes(1)};
};

}  // namespace lipofill::server
