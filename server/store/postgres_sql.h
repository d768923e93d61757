#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace lipofill::server {

/// Statements of the store as PostgreSQL takes them: ? and ?2 become $1 and $2; x'00' becomes a
/// bytea; BLOB, INTEGER and REAL become BYTEA, BIGINT and DOUBLE PRECISION; WITHOUT ROWID goes.
/// What stands between quotes stays. Checked by tests/unit/server/store/postgres_sql_test.cc.
std::string to_postgres(absl::string_view sql);

}  // namespace lipofill::server
