#include "server/entry/call_gate.h"

#include <google/protobuf/io/coded_stream.h>

#include <chrono>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/door/door.h"
#include "server/entry/method_rules.h"
#include "server/security/refusals.h"
#include "server/sessions/draining.h"
#include "server/sessions/memory_reserve.h"
#include "server/sessions/shortage.h"
#include "server/store/record_names.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// A refusal takes so long from its first look: what is another's was found in the store and what
/// is absent was not, which takes a few microseconds more or less.
constexpr std::chrono::microseconds kLookTime{300};

/// A request names two or three.
constexpr size_t kMostResources = 64;

std::vector<std::string> to_strings(const std::vector<grpc::string_ref>& values) {
  std::vector<std::string> texts;
  for (const grpc::string_ref& value : values) texts.emplace_back(value.data(), value.size());
  return texts;
}

Credentials credentials_of(const Metadata& metadata, const grpc::ServerContextBase& context) {
  Credentials credentials;
  const auto [first, last] = metadata.equal_range("authorization");
  for (auto entry = first; entry != last; ++entry) {
    credentials.authorization.emplace_back(entry->second.data(), entry->second.size());
  }
  credentials.is_unix_socket = absl::StartsWith(context.peer(), kUnixCallers);
  const auto transport = context.auth_context();
  if (transport != nullptr && transport->IsPeerAuthenticated()) {
    credentials.has_certificate = true;
    credentials.common_names = to_strings(transport->FindPropertyValues("x509_common_name"));
    credentials.alternative_names = to_strings(transport->FindPropertyValues("x509_subject_alternative_name"));
  }
  return credentials;
}

/// Notes the resources a request names for the audit log, up to a bound: a hostile request must not
/// fill the log.
void note_resources(Call& call, const ResourceNames& names) {
  call.resources.clear();
  for (const std::string& name : names.whole) {
    if (call.resources.size() < kMostResources) call.resources.push_back(name);
  }
}

AuditEntry audit_entry(const Call& call, const std::string& outcome) {
  const bool is_known = !absl::IsUnauthenticated(call.refusal);
  AuditEntry entry;
  entry.subject = is_known ? call.principal.subject : "";
  entry.tenant = is_known ? call.principal.scope.tenant : "";
  entry.role = is_known ? role_name(call.principal.role) : "";
  entry.method = call.method;
  entry.resources = call.resources;
  entry.made = call.made;
  entry.outcome = outcome;
  entry.request_id = call.request_id;
  return entry;
}

/// Tells whether all that is kept back is there, or could be put back.
bool has_memory() {
  if (!MemoryReserve::is_short()) return true;
  MemoryReserve::refill();
  return !MemoryReserve::is_short();
}

absl::Status no_memory() {
  constexpr double kRetryDelayS = 2.0;
  return shortage("NO_MEMORY", kRetryDelayS, "the daemon is out of memory for the moment; try again");
}

absl::Status no_resource(const std::string& name) {
  return absl::NotFoundError(absl::StrCat("there is no ", name));
}

/// Returns the first field of an answer, which for resources is their name; empty for anything
/// else.
std::string name_in(const grpc::ByteBuffer& message) {
  constexpr uint32_t kFirstFieldIsText = 0x0a;
  constexpr int kMaxName = 256;
  std::vector<grpc::Slice> slices;
  if (!message.Dump(&slices).ok() || slices.empty()) return "";
  google::protobuf::io::CodedInputStream in(slices[0].begin(), static_cast<int>(slices[0].size()));
  std::string name;
  int size = 0;
  if (in.ReadTag() != kFirstFieldIsText || !in.ReadVarintSizeAsInt(&size) || size > kMaxName) return "";
  if (!in.ReadString(&name, size)) return "";
  const bool is_name = absl::StartsWith(name, "patients/") || absl::StartsWith(name, "simulations/") ||
                       absl::StartsWith(name, "operations/");
  return is_name ? name : "";
}

}  // namespace

absl::Status CallGate::admit(Call& call, const Metadata& metadata, const grpc::ServerContextBase& context) {
  const absl::Status admitted = admit_by_rule(call, metadata, context);
  if (absl::IsUnauthenticated(admitted) || absl::IsPermissionDenied(admitted)) {
    const auto hints = hints_of(admitted);
    backend_.metrics.calls().count_refused(hints ? hints->reason : "OTHER");
  }
  return admitted;
}

absl::Status CallGate::admit_by_rule(Call& call, const Metadata& metadata, const grpc::ServerContextBase& context) {
  const MethodRule* rule = rule_of(call.method);
  if (rule == nullptr) return permission_denied("NO_RULE", "nobody may call this method: it has no rule");
  if (rule->is_open) return absl::OkStatus();
  auto principal = authenticator_.identify(credentials_of(metadata, context));
  if (!principal.ok()) return principal.status();
  call.principal = *std::move(principal);
  if (call.principal.role < rule->least) {
    return permission_denied("ROLE_TOO_LOW", absl::StrCat("this needs the role ", role_name(rule->least), ", ",
                                                          "the caller's is ", role_name(call.principal.role)));
  }
  if (backend_.stopping && rule->effect == Effect::kBegins) return draining();
  if (!rule->makes_room && !has_memory()) return no_memory();
  return absl::OkStatus();
}

absl::Status CallGate::check_admitted(Call& call, const google::protobuf::Message& request) {
  if (absl::IsPermissionDenied(call.refusal)) note_resources(call, resource_names_in(request));
  return call.refusal;
}

absl::Status CallGate::check(Call& call, const google::protobuf::Message& request) {
  if (call.principal.has_expired()) return token_expired();
  // An upload goes on with message after message, which were read already.
  if (const MethodRule* rule = rule_of(call.method); !rule->makes_room && !has_memory()) return no_memory();
  const ResourceNames names = resource_names_in(request);
  if (names.size() > kMostResources) {
    return absl::InvalidArgumentError(
        absl::StrCat("the request names ", names.size(), " resources, must name at most ", kMostResources));
  }
  note_resources(call, names);
  const auto began = std::chrono::steady_clock::now();
  if (const absl::Status within = check_reach(call.principal.scope, names); !within.ok()) {
    std::this_thread::sleep_until(began + kLookTime);
    return within;
  }
  return begin(call);
}

// When callers need not say who they are, resources are hidden from nobody: the gate lets the call
// pass and the method itself reports the missing resource.
absl::Status CallGate::check_owner(const Scope& scope, const absl::StatusOr<Owner>& owner, const std::string& name) {
  if (absl::IsNotFound(owner.status())) return authenticator_.asks() ? no_resource(name) : absl::OkStatus();
  // So that the user of this machine can delete what is damaged, whose owner nobody can tell.
  if (absl::IsDataLoss(owner.status()) && !authenticator_.asks()) return absl::OkStatus();
  if (!owner.ok()) return owner.status();
  return scope.has(owner->tenant, owner->patient) ? absl::OkStatus() : no_resource(name);
}

absl::Status CallGate::check_reach(const Scope& scope, const ResourceNames& names) {
  absl::Status reach;
  for (const std::string& id : names.patients) {
    reach.Update(check_owner(scope, backend_.store.owner_of_patient(id), patient_name(id)));
  }
  for (const std::string& id : names.simulations) {
    reach.Update(check_owner(scope, backend_.store.owner_of_simulation(id), simulation_name(id)));
  }
  for (const std::string& id : names.operations) {
    reach.Update(check_owner(scope, backend_.operations.owner_of(id), absl::StrCat("operations/", id)));
  }
  return reach;
}

absl::Status CallGate::begin(Call& call) {
  const MethodRule* rule = rule_of(call.method);
  if (call.begun || audit_ == nullptr || rule->effect == Effect::kNone || rule->is_frequent) return absl::OkStatus();
  const auto note = [this, &call] { return audit_->append_durably(audit_entry(call, "BEGUN")); };
  const absl::Status kept = rule->makes_room ? backend_.reserve.spend(note) : note();
  call.begun = kept.ok();
  if (kept.ok()) return kept;
  spdlog::error("the audit log cannot be written: {}", std::string(kept.message()));
  backend_.metrics.calls().count_refused("AUDIT_UNAVAILABLE");
  return with_hints(absl::UnavailableError("the audit log cannot be written; nothing is changed without it"),
                    {"AUDIT_UNAVAILABLE", 5.0});
}

void CallGate::sweep() {
  const auto revoked = authenticator_.revocations();
  live_calls_.sweep([&revoked](const Principal& principal) {
    return revoked != nullptr && revoked->has(principal) ? credentials_revoked() : absl::OkStatus();
  });
}

void CallGate::note_answer(Call& call, const grpc::ByteBuffer& message) {
  const MethodRule* rule = rule_of(call.method);
  if (audit_ == nullptr || rule == nullptr || rule->effect != Effect::kBegins || !call.made.empty()) return;
  call.made = name_in(message);
}

void CallGate::note_end(const Call& call, const std::string& code) {
  const MethodRule* rule = rule_of(call.method);
  if (audit_ == nullptr || rule == nullptr || rule->is_open) return;
  if (rule->is_frequent && call.refusal.ok()) return;
  if (absl::IsUnauthenticated(call.refusal) && !strangers_.take()) return;
  if (const absl::Status kept = audit_->append(audit_entry(call, code)); !kept.ok()) {
    spdlog::error("the audit log cannot be written: {}", std::string(kept.message()));
  }
}

}  // namespace lipofill::server
