#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::server {

/// One use of a prepared statement, as a kind of database makes it. Query is how it is used.
class Statement {
 public:
  virtual ~Statement() = default;
  virtual void bind(int index, int64_t value) = 0;
  virtual void bind(int index, double value) = 0;
  virtual void bind(int index, const std::string& bytes) = 0;
  /// Goes to the next row; false at the end, and at the first error, which sticks.
  virtual bool next() = 0;
  virtual const absl::Status& status() const = 0;

  virtual int64_t integer(int column) const = 0;  ///< 1 or 0 where the column is a condition
  virtual double real(int column) const = 0;
  virtual std::string text(int column) const = 0;  ///< text or bytes
};

/// The purpose of a transaction.
enum class Access { kLook, kChange };

/// A connection to one database; its users take turns (they hold a mutex of their own). All kinds
/// take the same statements: SQL as SQLite has it, of what PostgreSQL has too, with ? or ?1, ?2 for
/// what is bound and x'00' for bytes. Statements are prepared once.
/// Checked by tests/unit/server/store/store_test.cc over every kind.
class Database {
 public:
  virtual ~Database() = default;

  virtual std::unique_ptr<Statement> prepare(const char* sql) = 0;
  /// Carries out statements of this kind of database, one after the other.
  virtual absl::Status execute(const char* sql) = 0;
  /// The number of rows that the last statement changed.
  virtual int changes() const = 0;

  /// Begins what is done whole or not at all; Transaction is how it is used.
  virtual absl::Status begin(Access access) = 0;
  virtual absl::Status commit() = 0;
  virtual void roll_back() = 0;
  /// After a failure: true when nothing was done and the same may be tried again, for the
  /// `attempt`th time, counted from 0; waits as long as is fit before that.
  virtual bool may_try_again(int attempt) = 0;

  /// Lists what does not fit together below the level of records, in pages and indexes.
  virtual absl::StatusOr<std::vector<std::string>> find_faults() = 0;
  /// The version of the schema that its tables have.
  virtual absl::StatusOr<int64_t> schema_version() = 0;

  /// Tells whether other daemons may change what is in it.
  virtual bool is_shared() const = 0;
  /// Gives the name that messages have for it.
  virtual const std::string& name() const = 0;
};

/// One use of a prepared statement: bind, step through the rows, read columns. The first error
/// sticks and ends the rows.
///
///     Query query(db, "SELECT name FROM things WHERE size > ?");
///     query.bind(size);
///     while (query.next()) names.push_back(query.text(0));
///     return query.status();
class Query {
 public:
  Query(Database& database, const char* sql) : statement_(database.prepare(sql)) {}

  template <typename... Values>
  Query& bind(const Values&... values) {
    int index = 0;
    (bind_one(++index, values), ...);
    return *this;
  }
  bool next() { return statement_->next(); }
  /// Runs to the end.
  absl::Status run() {
    while (next()) {
    }
    return status();
  }
  const absl::Status& status() const { return statement_->status(); }

  int64_t integer(int column) const { return statement_->integer(column); }
  double real(int column) const { return statement_->real(column); }
  uint64_t unsigned_integer(int column) const { return static_cast<uint64_t>(integer(column)); }
  std::string text(int column) const { return statement_->text(column); }  ///< text or bytes
  bool is_true(int column) const { return integer(column) != 0; }

 private:
  void bind_one(int index, int64_t value) { statement_->bind(index, value); }
  void bind_one(int index, int value) { statement_->bind(index, static_cast<int64_t>(value)); }
  void bind_one(int index, uint64_t value) { statement_->bind(index, static_cast<int64_t>(value)); }
  void bind_one(int index, bool value) { statement_->bind(index, static_cast<int64_t>(value)); }
  void bind_one(int index, double value) { statement_->bind(index, value); }
  void bind_one(int index, const std::string& value) { statement_->bind(index, value); }

  std::unique_ptr<Statement> statement_;
};

/// Rolls back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database, Access access = Access::kChange)
      : database_(database), status_(database.begin(access)) {}
  ~Transaction() {
    if (status_.ok() && !committed_) database_.roll_back();
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  const absl::Status& status() const { return status_; }
  absl::Status commit() {
    const absl::Status done = database_.commit();
    committed_ = done.ok();
    return done;
  }

 private:
  Database& database_;
  absl::Status status_;
  bool committed_ = false;
};

}  // namespace lipofill::server
