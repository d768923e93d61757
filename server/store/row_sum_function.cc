#include "server/store/row_sum_function.h"

#include <sqlite3.h>

#include <cstdint>
#include <string>

#include "absl/strings/escaping.h"
#include "core/base/hash.h"

namespace lipofill::server {
namespace {

void add_value(sqlite3_value* value, Hasher& hasher) {
  switch (sqlite3_value_type(value)) {
    case SQLITE_INTEGER:
      hasher.add('i');
      return hasher.add(static_cast<int64_t>(sqlite3_value_int64(value)));
    case SQLITE_FLOAT:
      hasher.add('r');
      return hasher.add(sqlite3_value_double(value));
    case SQLITE_NULL:
      return hasher.add('n');
    default: {
      const void* bytes = sqlite3_value_blob(value);
      const auto size = static_cast<uint64_t>(sqlite3_value_bytes(value));
      hasher.add('b');
      hasher.add(size);
      hasher.add_bytes(bytes, size);
    }
  }
}

void row_sum(sqlite3_context* context, int count, sqlite3_value** values) {
  Hasher hasher;
  for (int i = 0; i < count; ++i) add_value(values[i], hasher);
  const std::string sum = absl::HexStringToBytes(hasher.hex_digest());
  sqlite3_result_blob(context, sum.data(), static_cast<int>(sum.size()), SQLITE_TRANSIENT);
}

}  // namespace

// Innocuous: triggers may call it although they are no trusted part of the schema.
int add_row_sum_function(sqlite3* handle) {
  return sqlite3_create_function_v2(handle, "row_sum", -1, SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS,
                                    nullptr, row_sum, nullptr, nullptr, nullptr);
}

}  // namespace lipofill::server
