#include "server/store/sqlite_database.h"

#include <sqlite3.h>

#include <cerrno>

#include "absl/strings/str_cat.h"
#include "server/store/durable_file.h"
#include "server/store/row_sum_function.h"

namespace lipofill::server {

namespace {

/// One use of a statement of SQLite's, which is reset afterwards.
class SqliteStatement : public Statement {
 public:
  SqliteStatement(const SqliteDatabase& database, const absl::StatusOr<sqlite3_stmt*>& prepared)
      : database_(database), statement_(prepared.value_or(nullptr)), status_(prepared.status()) {}
  ~SqliteStatement() override {
    if (statement_ == nullptr) return;
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
  }
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  void bind(int index, int64_t value) override {
    if (status_.ok()) note(sqlite3_bind_int64(statement_, index, value));
  }
  void bind(int index, double value) override {
    if (status_.ok()) note(sqlite3_bind_double(statement_, index, value));
  }
  void bind(int index, const std::string& bytes) override {
    if (status_.ok()) note(sqlite3_bind_blob64(statement_, index, bytes.data(), bytes.size(), SQLITE_TRANSIENT));
  }
  bool next() override {
    if (!status_.ok()) return false;
    errno = 0;
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    note(code);
    return false;
  }
  const absl::Status& status() const override { return status_; }

  int64_t integer(int column) const override { return sqlite3_column_int64(statement_, column); }
  double real(int column) const override { return sqlite3_column_double(statement_, column); }
  std::string text(int column) const override {
    const void* bytes = sqlite3_column_blob(statement_, column);
    const int size = sqlite3_column_bytes(statement_, column);
    return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), static_cast<size_t>(size));
  }

 private:
  void note(int code) {
    if (code != SQLITE_OK && code != SQLITE_DONE) status_ = database_.error(code);
  }

  const SqliteDatabase& database_;
  sqlite3_stmt* statement_;
  absl::Status status_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteDatabase>> SqliteDatabase::open(const std::string& path) {
  sqlite3* handle = nullptr;
  const int code =
      sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  std::unique_ptr<SqliteDatabase> database(new SqliteDatabase(handle, path));
  if (code != SQLITE_OK) {
    return absl::FailedPreconditionError(absl::StrCat("cannot open ", path, ": ", sqlite3_errstr(code)));
  }
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, 2000);
  if (const int added = add_row_sum_function(handle); added != SQLITE_OK) return database->error(added);
  return database;
}

SqliteDatabase::~SqliteDatabase() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close(handle_);
}

absl::Status SqliteDatabase::execute(const char* sql) {
  errno = 0;
  const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? absl::OkStatus() : error(code);
}

absl::Status SqliteDatabase::copy_to(const std::string& path) {
  const auto target = SqliteDatabase::open(path);
  if (!target.ok()) return target.status();
  errno = 0;
  sqlite3_backup* backup = sqlite3_backup_init((*target)->handle_, "main", handle_, "main");
  if (backup == nullptr) return (*target)->error(sqlite3_errcode((*target)->handle_));
  constexpr int kAllPages = -1;
  const int code = sqlite3_backup_step(backup, kAllPages);
  sqlite3_backup_finish(backup);
  return code == SQLITE_DONE ? absl::OkStatus() : (*target)->error(code);
}

absl::StatusOr<std::vector<std::string>> SqliteDatabase::find_faults() {
  std::vector<std::string> faults;
  Query check(*this, "PRAGMA integrity_check(20)");
  while (check.next()) {
    if (check.text(0) != "ok") faults.push_back(check.text(0));
  }
  if (!check.status().ok()) return check.status();
  return faults;
}

absl::StatusOr<int64_t> SqliteDatabase::schema_version() {
  Query version(*this, "PRAGMA user_version");
  if (!version.next()) return version.status();
  return version.integer(0);
}

int SqliteDatabase::changes() const {
  return sqlite3_changes(handle_);
}

std::unique_ptr<Statement> SqliteDatabase::prepare(const char* sql) {
  return std::make_unique<SqliteStatement>(*this, find_or_prepare(sql));
}

absl::StatusOr<sqlite3_stmt*> SqliteDatabase::find_or_prepare(const char* sql) {
  const auto known = statements_.find(sql);
  if (known != statements_.end()) return known->second;
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(handle_, sql, -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (code != SQLITE_OK) return error(code);
  statements_.emplace(sql, statement);
  return statement;
}

absl::Status SqliteDatabase::error(int code) const {
  const std::string message = absl::StrCat("store: ", sqlite3_errmsg(handle_));
  switch (code & 0xff) {
    case SQLITE_CONSTRAINT:
      // A trigger of ours found that a record is not what was written.
      if (code == SQLITE_CONSTRAINT_TRIGGER) return absl::DataLossError(message);
      return absl::AlreadyExistsError(message);
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      return absl::DataLossError(message);
    case SQLITE_FULL:
    case SQLITE_NOMEM:
    case SQLITE_TOOBIG:
      return absl::ResourceExhaustedError(message);
    case SQLITE_IOERR:
      // SQLite knows ENOSPC alone as a lack of room; of a quota or a limit it leaves no more than
      // this.
      if (is_out_of_space(errno)) {
        return absl::ResourceExhaustedError("store: no space is left in the data directory");
      }
      return absl::UnavailableError(message);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
      return absl::UnavailableError(message);
    default:
      return absl::InternalError(message);
  }
}

absl::Status SqliteDatabase::begin(Access access) {
  is_looking_ = access == Access::kLook;
  return is_looking_ ? absl::OkStatus() : execute("BEGIN IMMEDIATE");
}

absl::Status SqliteDatabase::commit() {
  return is_looking_ ? absl::OkStatus() : execute("COMMIT");
}

void SqliteDatabase::roll_back() {
  if (!is_looking_) execute("ROLLBACK").IgnoreError();
}

}  // namespace lipofill::server
