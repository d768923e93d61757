#pragma once

#include <google/protobuf/message.h>

#include "absl/status/status.h"

namespace lipofill::server {

/// Checks every request before anything looks into it: no field or enumerator this schema does not
/// know (it would silently be ignored), no number that is not finite. INVALID_ARGUMENT with a field
/// violation for each. Checked by tests/unit/server/wire/message_check_test.cc.
absl::Status check_message(const google::protobuf::Message& message);

}  // namespace lipofill::server
