#include "server/store/postgres_database.h"

#include <algorithm>
#include <pqxx/pqxx>
#include <random>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "server/store/postgres_sql.h"
#include "server/store/postgres_statement.h"

namespace lipofill::server {
namespace {

/// A call waits so long for a server that is started again; one that comes later does not wait.
constexpr std::chrono::seconds kPatience{3};
constexpr std::chrono::milliseconds kBetweenConnections{200};
/// It has to be known whether a change was done, so that is waited for longer.
constexpr std::chrono::seconds kPatienceInDoubt{10};
/// Many daemons may get in each other's way again and again; each of them has its turn in the end.
constexpr int kMostAttempts = 100;

/// The store counts on these settings of a connection. What a frozen daemon holds is taken from it.
/// Small tables are read by their indexes, for whoever reads a table whole gets in the way of all
/// who write to it.
constexpr char kSession[] =
    "SET idle_in_transaction_session_timeout = 3000; SET client_min_messages = error; SET bytea_output = hex; "
    "SET enable_seqscan = off; "
    "SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'";

std::string random_session() {
  std::random_device random;
  std::string session;
  for (int i = 0; i < 4; ++i) absl::StrAppend(&session, absl::StrFormat("%08x", random()));
  return session;
}

bool is_any_of(const std::string& state, std::initializer_list<const char*> states) {
  return std::find(states.begin(), states.end(), state) != states.end();
}

/// Turns a state of PostgreSQL's into a code for clients of the store.
absl::StatusCode code_of(const std::string& state) {
  if (absl::StartsWith(state, "23")) return absl::StatusCode::kAlreadyExists;
  if (absl::StartsWith(state, "XX00")) return absl::StatusCode::kDataLoss;
  if (is_any_of(state, {"53100", "53200"}) || absl::StartsWith(state, "54")) {
    return absl::StatusCode::kResourceExhausted;
  }
  if (is_any_of(state, {"25006", "42501", "53300", "40001", "40P01", "55P03", "57014"}) ||
      absl::StartsWith(state, "08") || absl::StartsWith(state, "57P")) {
    return absl::StatusCode::kUnavailable;
  }
  if (state == "3F000") return absl::StatusCode::kFailedPrecondition;  // no such schema
  return absl::StatusCode::kInternal;
}

/// The first line of a message; those that follow quote the statement.
std::string first_line(const std::string& message) {
  const std::string line = message.substr(0, message.find('\n'));
  return absl::StrReplaceAll(line, {{"ERROR:  ", ""}, {"FATAL:  ", ""}});
}

}  // namespace

/// A connection as libpqxx has it. Its own transactions would connect again in the midst of a
/// transaction and forget what was begun, so BEGIN and COMMIT are statements like others here.
class PostgresConnection {
 public:
  explicit PostgresConnection(const std::string& settings) : connection_(settings) { statements_.exec(kSession); }

  bool is_open() const { return connection_.is_open(); }
  pqxx::result execute(const std::string& sql) { return statements_.exec(sql); }
  pqxx::result execute_prepared(const std::string& sql, const std::vector<pqxx::binarystring>& parameters) {
    const auto [known, is_new] = names_.try_emplace(sql, absl::StrCat("s", names_.size()));
    if (is_new) connection_.prepare(known->second, to_postgres(sql));
    return statements_.exec_prepared(known->second, pqxx::prepare::make_dynamic_params(parameters));
  }

 private:
  pqxx::connection connection_;
  pqxx::quiet_errorhandler quiet_{connection_};
  pqxx::nontransaction statements_{connection_};
  std::map<std::string, std::string> names_;  ///< of prepared statements
};

absl::StatusOr<std::unique_ptr<PostgresDatabase>> PostgresDatabase::open(const std::string& address) {
  auto parsed = parse_postgres_address(address);
  if (!parsed.ok()) return parsed.status();
  std::unique_ptr<PostgresDatabase> database(new PostgresDatabase(*std::move(parsed)));
  absl::Status connected = database->connect();
  for (int attempt = 0; !connected.ok() && database->may_try_again(attempt); ++attempt) connected = database->connect();
  if (!connected.ok()) return connected;
  return database;
}

PostgresDatabase::PostgresDatabase(PostgresAddress address) : address_(std::move(address)) {}

PostgresDatabase::~PostgresDatabase() {
  if (session_.empty() || connection_ == nullptr) return;
  execute(absl::StrCat("DELETE FROM last_changes WHERE session = '", session_, "'").c_str()).IgnoreError();
}

absl::Status PostgresDatabase::connect() {
  if (Clock::now() < retry_after_) return note_loss("it is tried again in a moment");
  connection_ = nullptr;
  try {
    connection_ = std::make_unique<PostgresConnection>(address_.settings);
  } catch (const std::exception& error) {
    retry_after_ = Clock::now() + kBetweenConnections;
    return note_loss(error.what());
  }
  lost_at_ = retry_after_ = {};
  return absl::OkStatus();
}

absl::Status PostgresDatabase::reach() {
  if (connection_ != nullptr && connection_->is_open()) return absl::OkStatus();
  return is_begun_ ? note_loss("the connection was lost") : connect();
}

absl::Status PostgresDatabase::note_loss(const std::string& why) {
  connection_ = nullptr;
  failure_ = Failure::kLost;
  if (lost_at_ == Clock::time_point()) lost_at_ = Clock::now();
  return absl::UnavailableError(absl::StrCat("store: no connection to ", address_.name, ": ", first_line(why)));
}

absl::Status PostgresDatabase::note_failure(const std::string& state, const std::string& message) {
  if (connection_ == nullptr || !connection_->is_open()) return note_loss(message);
  if (is_any_of(state, {"40001", "40P01"})) failure_ = Failure::kConflict;
  return absl::Status(code_of(state), absl::StrCat("store: ", first_line(message)));
}

template <typename Work>
absl::Status PostgresDatabase::guard(const Work& work) {
  if (is_begun_ && !begun_status_.ok()) return begun_status_;
  absl::Status done = reach();
  if (done.ok()) {
    try {
      work();
    } catch (const pqxx::sql_error& error) {
      done = note_failure(error.sqlstate(), error.what());
    } catch (const std::exception& error) {
      done = note_failure("", error.what());
    }
  }
  if (is_begun_) begun_status_.Update(done);
  return done;
}

std::unique_ptr<Statement> PostgresDatabase::prepare(const char* sql) {
  return std::make_unique<PostgresStatement>(*this, sql);
}

absl::StatusOr<pqxx::result> PostgresDatabase::execute_prepared(const std::string& sql,
                                                                const std::vector<std::string>& parameters) {
  const std::vector<pqxx::binarystring> bytes(parameters.begin(), parameters.end());
  pqxx::result result;
  const absl::Status done = guard([&] { result = connection_->execute_prepared(sql, bytes); });
  if (!done.ok()) return done;
  changes_ = static_cast<int>(result.affected_rows());
  return result;
}

absl::Status PostgresDatabase::execute(const char* sql) {
  return guard([&] { changes_ = static_cast<int>(connection_->execute(sql).affected_rows()); });
}

absl::Status PostgresDatabase::begin(Access access) {
  failure_ = Failure::kNone;
  access_ = access;
  std::string sql = "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY";
  if (access == Access::kChange) {
    sql = "BEGIN ISOLATION LEVEL SERIALIZABLE";
    if (!session_.empty()) {
      absl::StrAppend(&sql, "; UPDATE last_changes SET number = ", ++n_changes_, ", since = now() WHERE session = '",
                      session_, "'");
    }
  }
  const absl::Status begun = execute(sql.c_str());
  is_begun_ = begun.ok();
  begun_status_ = absl::OkStatus();
  if (begun.ok() && access == Access::kChange && !session_.empty() && changes_ != 1) {
    roll_back();
    return absl::DataLossError(absl::StrCat("store: the row of this daemon in last_changes of ", address_.name,
                                            " is gone; the daemon must be started again"));
  }
  if (!begun.ok()) execute("ROLLBACK").IgnoreError();
  return begun;
}

absl::Status PostgresDatabase::commit() {
  if (!begun_status_.ok()) return begun_status_;
  absl::Status done = guard([&] { connection_->execute("COMMIT"); });
  const bool is_in_doubt = failure_ == Failure::kLost && access_ == Access::kChange;
  is_begun_ = false;
  return is_in_doubt ? ask_after_change() : done;
}

absl::Status PostgresDatabase::ask_after_change() {
  const auto until = Clock::now() + kPatienceInDoubt;
  const std::string sql = absl::StrCat("SELECT number FROM last_changes WHERE session = '", session_, "' FOR UPDATE");
  while (!session_.empty() && Clock::now() < until) {
    int64_t number = -1;
    // The row is locked by whom COMMIT was asked of, as long as that is under way.
    const absl::Status asked = guard([&] {
      const pqxx::result rows = connection_->execute(sql);
      if (!rows.empty()) number = rows[0][0].as<int64_t>();
    });
    if (asked.ok() && number == n_changes_) return absl::OkStatus();
    if (asked.ok() && number >= 0) {
      failure_ = Failure::kLost;
      return absl::UnavailableError(absl::StrCat("store: the connection to ", address_.name, " was lost"));
    }
    std::this_thread::sleep_for(kBetweenConnections);
  }
  failure_ = Failure::kNone;
  return absl::UnavailableError(absl::StrCat("store: the connection to ", address_.name,
                                             " was lost at the end of a change; it is not known whether it was made"));
}

void PostgresDatabase::roll_back() {
  const Failure failure = failure_;  // why it is rolled back is what counts
  is_begun_ = false;
  if (connection_ != nullptr && connection_->is_open()) execute("ROLLBACK").IgnoreError();
  failure_ = failure;
}

bool PostgresDatabase::may_try_again(int attempt) {
  if (attempt >= kMostAttempts) return false;
  if (failure_ == Failure::kConflict) {
    // Two that met do not wait equally long.
    const int range_ms = std::min(2 << std::min(attempt, 5), 50);
    std::this_thread::sleep_for(std::chrono::milliseconds(1 + static_cast<int>(std::random_device()() % range_ms)));
    return true;
  }
  const bool is_lost_for_long = lost_at_ != Clock::time_point() && Clock::now() > lost_at_ + kPatience;
  if (failure_ != Failure::kLost || is_lost_for_long) return false;
  if (connection_ == nullptr) std::this_thread::sleep_until(std::max(retry_after_, Clock::now()));
  return true;
}

absl::Status PostgresDatabase::note_changes() {
  session_ = random_session();
  absl::Status done = execute("DELETE FROM last_changes WHERE since < now() - interval '30 days'");
  done.Update(execute(absl::StrCat("INSERT INTO last_changes VALUES ('", session_, "', 0, now())").c_str()));
  return done;
}

absl::StatusOr<int64_t> PostgresDatabase::schema_version() {
  Query version(*this, "SELECT version FROM lipofill_schema");
  if (version.next()) return version.integer(0);
  return version.status().ok() ? absl::DataLossError("the database does not say which schema it has")
                               : version.status();
}

}  // namespace lipofill::server
