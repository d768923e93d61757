#include "server/store/sqlite.h"

#include <sqlite3.h>

#include <cerrno>

#include "absl/strings/str_cat.h"
#include "server/store/durable_file.h"
#include "server/store/row_sum_function.h"

namespace lipofill::server {

Query::Query(Database& database, const char* sql) : database_(database) {
  auto prepared = database.prepare(sql);
  if (prepared.ok()) {
    statement_ = *prepared;
  } else {
    status_ = prepared.status();
  }
}

Query::~Query() {
  if (statement_ == nullptr) return;
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

bool Query::next() {
  if (!status_.ok()) return false;
  errno = 0;
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  note(code);
  return false;
}

absl::Status Query::run() {
  while (next()) {
  }
  return status_;
}

int64_t Query::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double Query::real(int column) const {
  return sqlite3_column_double(statement_, column);
}

std::string Query::text(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), static_cast<size_t>(size));
}

void Query::bind_one(int index, int64_t value) {
  if (status_.ok()) note(sqlite3_bind_int64(statement_, index, value));
}

void Query::bind_one(int index, double value) {
  if (status_.ok()) note(sqlite3_bind_double(statement_, index, value));
}

void Query::bind_one(int index, const std::string& value) {
  if (status_.ok()) note(sqlite3_bind_blob64(statement_, index, value.data(), value.size(), SQLITE_TRANSIENT));
}

void Query::note(int code) {
  if (code != SQLITE_OK && code != SQLITE_DONE) status_ = database_.error(code);
}

absl::StatusOr<std::unique_ptr<Database>> Database::open(const std::string& path) {
  sqlite3* handle = nullptr;
  const int code =
      sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  std::unique_ptr<Database> database(new Database(handle));
  if (code != SQLITE_OK) {
    return absl::FailedPreconditionError(absl::StrCat("cannot open ", path, ": ", sqlite3_errstr(code)));
  }
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, 2000);
  if (const int added = add_row_sum_function(handle); added != SQLITE_OK) return database->error(added);
  return database;
}

Database::~Database() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close(handle_);
}

absl::Status Database::execute(const char* sql) {
  errno = 0;
  const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? absl::OkStatus() : error(code);
}

absl::Status Database::copy_to(const std::string& path) {
  const auto target = Database::open(path);
  if (!target.ok()) return target.status();
  errno = 0;
  sqlite3_backup* backup = sqlite3_backup_init((*target)->handle_, "main", handle_, "main");
  if (backup == nullptr) return (*target)->error(sqlite3_errcode((*target)->handle_));
  constexpr int kAllPages = -1;
  const int code = sqlite3_backup_step(backup, kAllPages);
  sqlite3_backup_finish(backup);
  return code == SQLITE_DONE ? absl::OkStatus() : (*target)->error(code);
}

int Database::changes() const {
  return sqlite3_changes(handle_);
}

absl::StatusOr<sqlite3_stmt*> Database::prepare(const char* sql) {
  const auto known = statements_.find(sql);
  if (known != statements_.end()) return known->second;
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(handle_, sql, -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (code != SQLITE_OK) return error(code);
  statements_.emplace(sql, statement);
  return statement;
}

absl::Status Database::error(int code) const {
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

Transaction::~Transaction() {
  if (status_.ok() && !committed_) database_.execute("ROLLBACK").IgnoreError();
}

absl::Status Transaction::commit() {
  const absl::Status done = database_.execute("COMMIT");
  committed_ = done.ok();
  return done;
}

}  // namespace lipofill::server
