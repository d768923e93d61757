#pragma once

#include <string>

#include "tests/unit/server/postgres_server.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {

/// The kinds of database that a store may be in.
enum class StoreKind { kSqlite, kPostgres };

/// A place for a new store: a file in the directory, or an empty schema of a real server.
inline std::string make_place(StoreKind kind, const lipofill::testing::TemporaryDirectory& directory) {
  return kind == StoreKind::kSqlite ? directory.file("db")
                                    : lipofill::testing::PostgresServer::of_program().make_place();
}

inline std::string kind_name(const ::testing::TestParamInfo<StoreKind>& info) {
  return info.param == StoreKind::kSqlite ? "Sqlite" : "Postgres";
}

}  // namespace lipofill::server
