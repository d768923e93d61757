#pragma once

struct sqlite3;

namespace lipofill::server {

/// Gives a connection the SQL function row_sum(...): the SHA-256, 32 bytes, of its arguments, each
/// with its kind (number, real, bytes, nothing) and its length. Text and blobs of equal bytes are
/// equal. Returns SQLite's code.
/// Checked by tests/unit/server/store/row_sums_test.cc.
int add_row_sum_function(sqlite3* handle);

}  // namespace lipofill::server
