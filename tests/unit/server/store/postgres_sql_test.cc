#include "server/store/postgres_sql.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

TEST(PostgresSql, NumbersWhatIsBound) {
  EXPECT_EQ(to_postgres("a = ? AND b = ?"), "a = $1 AND b = $2");
  EXPECT_EQ(to_postgres("a = ?2 OR b = ?12"), "a = $2 OR b = $12");
}

TEST(PostgresSql, NamesTypesAsPostgresDoes) {
  EXPECT_EQ(to_postgres("x BLOB, n INTEGER, r REAL) WITHOUT ROWID;"), "x BYTEA, n BIGINT, r DOUBLE PRECISION);");
  EXPECT_EQ(to_postgres("BLOBS _REAL INTEGER_"), "BLOBS _REAL INTEGER_") << "other words";
}

TEST(PostgresSql, TurnsBytesAndLeavesTexts) {
  EXPECT_EQ(to_postgres("x'2f' || 'a ? BLOB' || x''"), "'\\x2f'::bytea || 'a ? BLOB' || '\\x'::bytea");
  EXPECT_EQ(to_postgres("'it''s ?' = ?"), "'it''s ?' = $1");
  EXPECT_EQ(to_postgres("max'"), "max'") << "an open quote is left to the server to refuse";
}

}  // namespace
}  // namespace lipofill::server
