#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/store/data_directory.h"
#include "server/store/sql_store.h"

namespace lipofill::server {

/// A store that is to be served.
struct OpenedStore {
  std::unique_ptr<SqlStore> store;
  std::string remark;  ///< what is not as it should be, and yet no reason not to serve
};

/// Opens the store of a data directory with its database at `place` (see open_database()), or makes
/// it where there is none. FAILED_PRECONDITION, and nothing is removed, where the directory has
/// files of a store and no database, an empty one, or that of another directory: directory and
/// database both have the store's id; so, too, where a database of PostgreSQL was served before and
/// the directory does not say that it is the one with its files. A database that is
/// older than the directory, which knows how often it was started, is remarked upon.
/// Checked by tests/unit/server/store/store_opening_test.cc and
/// tests/integration/service/missing_data_test.cc.
absl::StatusOr<OpenedStore> open_store_to_serve(const DataDirectory& data, const std::string& place);

/// FAILED_PRECONDITION naming what a directory holds of a store; OK where that is nothing.
absl::Status check_holds_no_store(const DataDirectory& data);

}  // namespace lipofill::server
