#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pqxx/result"
#include "server/store/postgres_database.h"

namespace lipofill::server {

/// One use of a statement of PostgreSQL's: it is carried out at the first call of next(), and all
/// rows come at once. Checked by tests/unit/server/store/postgres_database_test.cc.
class PostgresStatement : public Statement {
 public:
  PostgresStatement(PostgresDatabase& database, const char* sql) : database_(database), sql_(sql) {}

  void bind(int index, int64_t value) override;
  void bind(int index, double value) override;
  void bind(int index, const std::string& bytes) override;
  bool next() override;
  const absl::Status& status() const override { return status_; }

  int64_t integer(int column) const override;
  double real(int column) const override;
  std::string text(int column) const override;

 private:
  pqxx::field field(int column) const;

  PostgresDatabase& database_;
  const std::string sql_;
  std::vector<std::string> parameters_;  ///< in PostgreSQL's binary form
  std::optional<pqxx::result> rows_;
  int row_ = -1;
  absl::Status status_;
};

}  // namespace lipofill::server
