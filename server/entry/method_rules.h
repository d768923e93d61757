#pragma once

#include <string>

#include "server/security/principal.h"

namespace lipofill::server {

/// The effect of a call on the daemon.
enum class Effect {
  kNone,    ///< looks
  kSteers,  ///< changes or ends what is there
  kBegins,  ///< brings in something new, or work: refused while the daemon drains
};

/// The effect of a method, and the role it needs.
struct MethodRule {
  Effect effect = Effect::kNone;
  Role least = Role::kAdmin;
  bool is_open = false;      ///< everybody may call it, also who does not say who they are
  bool is_frequent = false;  ///< so often that the audit log has only what is refused of it
  bool makes_room = false;   ///< the room that is kept back is for it
};

/// The rule of a method by its full name, "/lipofill.v1.PatientService/GetPatient"; nullptr without
/// one: nobody may call it. A new method must have its line in the table:
/// tests/unit/server/entry/call_test.cc walks all services.
const MethodRule* rule_of(const std::string& method);

/// True when the table has the method.
bool has_rule(const std::string& method);

}  // namespace lipofill::server
