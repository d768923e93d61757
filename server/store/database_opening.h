#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/store/database.h"

namespace lipofill::server {

/// Tells whether a place is the address of a database of PostgreSQL, "postgresql://...", and not a
/// file.
bool is_postgres(const std::string& place);

/// Opens a database that is to be served, checks it, and brings its schema up to date; makes the
/// schema where there is none. A place is a file, of SQLite, or the address of a database of
/// PostgreSQL. DATA_LOSS for one that is damaged, FAILED_PRECONDITION for one of another program or
/// of a newer schema, UNAVAILABLE where it cannot be reached.
/// Checked by tests/unit/server/store/store_test.cc and schema_test.cc.
absl::StatusOr<std::unique_ptr<Database>> open_database(const std::string& place);

/// Tells whether there is anything of a store at a place; nothing is made there.
absl::StatusOr<bool> holds_store(const std::string& place);

/// Opens a database that a daemon may serve meanwhile, to read it as it is. FAILED_PRECONDITION
/// where there is no store.
absl::StatusOr<std::unique_ptr<Database>> open_database_to_look(const std::string& place);

}  // namespace lipofill::server
