#pragma once

#include <string>
#include <vector>

#include "server/ops/settings.h"
#include "server/security/security_settings.h"

namespace lipofill::server {

/// The settings of who may do what.
std::vector<Setting> settings_of(SecuritySettings& security);

/// Looks through files of an audit log, and at the anchor beside the last of them, and says what
/// was found. The exit code: 0, or 1 when a line was changed, taken out or put in, or the end cut
/// off.
/// @param key_file  of the key that signed the anchor, private or public; empty: it is not asked
///                  for
int print_audit_verification(const std::vector<std::string>& files, const std::string& key_file);

}  // namespace lipofill::server
