#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>

#include <string>

#include "absl/status/status.h"
#include "server/backend/backend.h"
#include "server/entry/call.h"
#include "server/security/allowance.h"
#include "server/security/audit_log.h"
#include "server/security/authenticator.h"
#include "server/wire/resource_names.h"

namespace lipofill::server {

/// What stands before every call, of any service: who calls, whether the method is for their role, whether what the
/// request names is theirs, and the audit log. What is another's is answered as what is not there, before anything else
/// of the request is looked at, so that no answer tells the two apart.
/// Checked by tests/integration/security/.
class CallGate {
 public:
  /// `audit` may be nullptr: nothing is written down then.
  CallGate(Backend& backend, const Authenticator& authenticator, AuditLog* audit)
      : backend_(backend), authenticator_(authenticator), audit_(audit) {}

  /// With the metadata, before there is a request: fills in who calls. UNAUTHENTICATED, PERMISSION_DENIED, or
  /// draining().
  absl::Status admit(Call& call, const Metadata& metadata, const grpc::ServerContextBase& context);
  /// What admit() said; what a request that is refused was about is noted where it is known who sent it.
  absl::Status check_admitted(Call& call, const google::protobuf::Message& request);
  /// With the request, before the method looks at it; of a stream with every message. Calls that change something are
  /// written to the audit log, durably, before they do: UNAVAILABLE when that cannot be.
  absl::Status check(Call& call, const google::protobuf::Message& request);
  /// Of callers whom nobody knows, a hundred a minute are written down: they must not fill the medium. The others are
  /// counted, as all are, in the metrics.
  void note_end(const Call& call, const std::string& code);
  /// The answer of a call that makes something says how that is called.
  void note_answer(Call& call, const grpc::ByteBuffer& message);

 private:
  absl::Status admit_by_rule(Call& call, const Metadata& metadata, const grpc::ServerContextBase& context);
  absl::Status check_owner(const Scope& scope, const absl::StatusOr<Owner>& owner, const std::string& name);
  absl::Status check_reach(const Scope& scope, const ResourceNames& names);
  absl::Status begin(Call& call);

  Backend& backend_;
  const Authenticator& authenticator_;
  AuditLog* const audit_;
  Allowance strangers_{100, std::chrono::minutes(1)};
};

}  // namespace lipofill::server
