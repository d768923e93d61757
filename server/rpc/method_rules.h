#pragma once

#include <string>

namespace lipofill::server {

/// What a call does to the daemon.
enum class Effect {
  kNone,    ///< looks
  kSteers,  ///< changes or ends what is there
  kBegins,  ///< brings in something new, or work: refused while the daemon drains
};

/// The effect of a method by its full name, "/lipofill.v1.PatientService/GetPatient"; kNone of one that there is not. A
/// new method must have its line in the table: tests/unit/server/call_test.cc walks all services.
Effect effect_of(const std::string& method);

/// Whether the table has it.
bool has_rule(const std::string& method);

}  // namespace lipofill::server
