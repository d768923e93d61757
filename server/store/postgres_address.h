#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace lipofill::server {

/// The address of a database of PostgreSQL, and what may be said of it.
struct PostgresAddress {
  std::string settings;  ///< for libpq: the address, with what this program sets where it sets nothing
  std::string name;      ///< host, port and database, for messages
};

/// Reads "postgresql://user@host:port/database?...". INVALID_ARGUMENT for one that libpq does not
/// understand, no part of which is repeated, and for one with a password: everyone on the machine
/// sees the command line of a daemon, and what it says of its settings.
/// Checked by tests/unit/server/store/postgres_address_test.cc.
absl::StatusOr<PostgresAddress> parse_postgres_address(const std::string& address);

}  // namespace lipofill::server
