#include "server/store/postgres_address.h"

#include <libpq-fe.h>

#include <map>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace lipofill::server {
namespace {

/// A network that falls silent is noticed within 10 s.
const std::map<std::string, std::string> kDefaults = {
    {"application_name", "lipofilld"}, {"connect_timeout", "2"},  {"keepalives_idle", "4"},
    {"keepalives_interval", "2"},      {"keepalives_count", "3"}, {"tcp_user_timeout", "10000"},
};

std::string quoted(const std::string& value) {
  return absl::StrCat("'", absl::StrReplaceAll(value, {{"\\", "\\\\"}, {"'", "\\'"}}), "'");
}

std::string value_or(const std::map<std::string, std::string>& values, const char* key, const char* otherwise) {
  const auto found = values.find(key);
  return found == values.end() ? otherwise : found->second;
}

/// Reads what an address gives; nothing where it is not understood.
std::map<std::string, std::string> read_values(const std::string& address) {
  std::map<std::string, std::string> values;
  char* why_not = nullptr;
  const std::unique_ptr<PQconninfoOption, void (*)(PQconninfoOption*)> read(PQconninfoParse(address.c_str(), &why_not),
                                                                            PQconninfoFree);
  PQfreemem(why_not);
  if (read == nullptr) return values;
  for (const PQconninfoOption* option = read.get(); option->keyword != nullptr; ++option) {
    if (option->val != nullptr) values[option->keyword] = option->val;
  }
  values.insert(kDefaults.begin(), kDefaults.end());
  return values;
}

}  // namespace

absl::StatusOr<PostgresAddress> parse_postgres_address(const std::string& address) {
  const auto values = read_values(address);
  if (values.empty()) {
    return absl::InvalidArgumentError(
        "the address of the database is not understood; it must be like "
        "postgresql://user@host:5432/database?sslmode=verify-full, with %40 for @ and so on within its parts");
  }
  if (values.contains("password")) {
    return absl::InvalidArgumentError(
        "the address of the database holds a password, which must stand in the file that PGPASSFILE names, or in "
        "~/.pgpass, as a line host:port:database:user:password");
  }
  PostgresAddress read;
  for (const auto& [key, value] : values) absl::StrAppend(&read.settings, key, "=", quoted(value), " ");
  read.name = absl::StrCat("postgresql://", value_or(values, "host", "(local)"), ":", value_or(values, "port", "5432"),
                           "/", value_or(values, "dbname", ""));
  return read;
}

}  // namespace lipofill::server
