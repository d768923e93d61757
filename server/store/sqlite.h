#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

struct sqlite3;
struct sqlite3_stmt;

namespace lipofill::server {

class Database;

/// One use of a prepared statement: bind, step through the rows, read columns. The first error
/// sticks and ends the rows.
///
///     Query query(db, "SELECT name FROM things WHERE size > ?");
///     query.bind(size);
///     while (query.next()) names.push_back(query.text(0));
///     return query.status();
class Query {
 public:
  Query(Database& database, const char* sql);
  ~Query();
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  template <typename... Values>
  Query& bind(const Values&... values) {
    int index = 0;
    (bind_one(++index, values), ...);
    return *this;
  }
  bool next();
  /// Runs to the end.
  absl::Status run();
  const absl::Status& status() const { return status_; }

  int64_t integer(int column) const;
  double real(int column) const;
  uint64_t unsigned_integer(int column) const { return static_cast<uint64_t>(integer(column)); }
  std::string text(int column) const;  ///< text or blob
  bool is_true(int column) const { return integer(column) != 0; }

 private:
  void bind_one(int index, int64_t value);
  void bind_one(int index, int value) { bind_one(index, static_cast<int64_t>(value)); }
  void bind_one(int index, uint64_t value) { bind_one(index, static_cast<int64_t>(value)); }
  void bind_one(int index, bool value) { bind_one(index, static_cast<int64_t>(value)); }
  void bind_one(int index, double value);
  void bind_one(int index, const std::string& value);
  void note(int code);

  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  absl::Status status_;
};

/// A connection to one database file; its users take turns (they hold a mutex of their own).
/// Statements are prepared once.
class Database {
 public:
  static absl::StatusOr<std::unique_ptr<Database>> open(const std::string& path);
  ~Database();

  absl::Status execute(const char* sql);
  int changes() const;
  /// Copies the whole database, as this connection sees it now, to a new file.
  absl::Status copy_to(const std::string& path);

 private:
  friend class Query;
  explicit Database(sqlite3* handle) : handle_(handle) {}
  absl::StatusOr<sqlite3_stmt*> prepare(const char* sql);
  absl::Status error(int code) const;

  sqlite3* handle_;
  std::map<std::string, sqlite3_stmt*> statements_;
};

/// Rolls back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database), status_(database.execute("BEGIN IMMEDIATE")) {}
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  const absl::Status& status() const { return status_; }
  absl::Status commit();

 private:
  Database& database_;
  absl::Status status_;
  bool committed_ = false;
};

}  // namespace lipofill::server
