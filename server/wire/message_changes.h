#pragma once

#include <google/protobuf/message.h>

#include <string>
#include <vector>

#include "core/base/field_violations.h"

namespace lipofill::server {

/// The fields in which a message differs from what it was: the path of each, and what it was and
/// what it is, "was 2, is 3". What was added or taken out as a whole is one change. At most `most`,
/// in the order of the schema. Checked by tests/unit/server/wire/message_changes_test.cc.
std::vector<FieldViolation> changes_between(const google::protobuf::Message& before,
                                            const google::protobuf::Message& after, size_t most);

}  // namespace lipofill::server
