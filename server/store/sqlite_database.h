#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/store/database.h"

struct sqlite3;
struct sqlite3_stmt;

namespace lipofill::server {

/// A database in one file. Checked by tests/unit/server/store/store_test.cc.
class SqliteDatabase : public Database {
 public:
  static absl::StatusOr<std::unique_ptr<SqliteDatabase>> open(const std::string& path);
  ~SqliteDatabase() override;

  std::unique_ptr<Statement> prepare(const char* sql) override;
  absl::Status execute(const char* sql) override;
  int changes() const override;
  /// One who only looks begins nothing: nobody else writes, and the users of a connection take
  /// turns.
  absl::Status begin(Access access) override;
  absl::Status commit() override;
  void roll_back() override;
  bool may_try_again(int) override { return false; }
  absl::StatusOr<std::vector<std::string>> find_faults() override;
  absl::StatusOr<int64_t> schema_version() override;
  bool is_shared() const override { return false; }
  const std::string& name() const override { return path_; }

  /// Copies the whole database, as this connection sees it now, to a new file.
  absl::Status copy_to(const std::string& path);
  /// Turns a code of SQLite's into a status that has its message of the last call.
  absl::Status error(int code) const;

 private:
  SqliteDatabase(sqlite3* handle, std::string path) : handle_(handle), path_(std::move(path)) {}
  absl::StatusOr<sqlite3_stmt*> find_or_prepare(const char* sql);

  sqlite3* handle_;
  const std::string path_;
  std::map<std::string, sqlite3_stmt*> statements_;
  bool is_looking_ = false;
};

}  // namespace lipofill::server
