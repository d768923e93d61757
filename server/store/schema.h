#pragma once

#include <string>

#include "absl/status/status.h"
#include "server/store/database.h"

namespace lipofill::server {

/// Version of the schema that this program writes, PRAGMA user_version.
inline constexpr int kSchemaVersion = 7;

/// Checks the database, and makes indexes that do not go with their tables again. DATA_LOSS saying
/// what is wrong and what can be done when its pages do not fit together. Checked by
/// tests/unit/server/store/schema_test.cc and tests/integration/service/fault_test.cc.
absl::Status check_database(Database& database, const std::string& path);

/// Makes the tables of an empty database, or takes one of an earlier version to this one, step by
/// step in one transaction. FAILED_PRECONDITION for a database of another program or of a later
/// version, which stays as it is.
/// Checked by tests/unit/server/store/schema_test.cc from every earlier version.
absl::Status bring_up_to_date(Database& database, const std::string& path);

}  // namespace lipofill::server
