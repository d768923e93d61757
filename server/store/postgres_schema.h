#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/postgres_database.h"

namespace lipofill::server {

/// Makes the tables of the store where the schema of the connection, the first of its search_path,
/// is empty, or takes those of an earlier version to this one; in one transaction, and one daemon
/// after the other. From then on changes are noted, see PostgresDatabase::note_changes().
/// FAILED_PRECONDITION for a schema that holds something else, or of a later version, which stays
/// as it is. Checked by tests/unit/server/store/postgres_schema_test.cc.
absl::Status bring_postgres_up_to_date(PostgresDatabase& database);

/// Tells whether the schema of the connection has the tables of a store.
absl::StatusOr<bool> holds_postgres_store(PostgresDatabase& database);

/// OK where there is a store of this version whose triggers are all there. FAILED_PRECONDITION
/// where there is none, DATA_LOSS naming what is not as it was made.
absl::Status check_postgres_schema(PostgresDatabase& database);

}  // namespace lipofill::server
