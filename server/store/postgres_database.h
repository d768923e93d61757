#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/store/database.h"
#include "server/store/postgres_address.h"

namespace pqxx {
class result;
}

namespace lipofill::server {

class PostgresConnection;

/// A database of PostgreSQL, over a connection that is made again when it was lost.
///
/// Changes are SERIALIZABLE: where two daemons come between each other, one fails and is to begin
/// anew, see may_try_again(); looks see one moment and never fail for that. A connection that is
/// lost before COMMIT leaves nothing done, which is to begin anew too. Where it is lost during
/// COMMIT, the row of this database's last change tells whether that was done, so that nothing is
/// done twice. UNAVAILABLE while the server cannot be reached.
/// Checked by tests/unit/server/store/postgres_database_test.cc with servers that stop.
class PostgresDatabase : public Database {
 public:
  /// Connects. INVALID_ARGUMENT for an address that is none, UNAVAILABLE without a server.
  static absl::StatusOr<std::unique_ptr<PostgresDatabase>> open(const std::string& address);
  ~PostgresDatabase() override;

  std::unique_ptr<Statement> prepare(const char* sql) override;
  absl::Status execute(const char* sql) override;
  int changes() const override { return changes_; }
  absl::Status begin(Access access) override;
  absl::Status commit() override;
  void roll_back() override;
  bool may_try_again(int attempt) override;
  /// The server checks its pages itself, where it was made with checksums.
  absl::StatusOr<std::vector<std::string>> find_faults() override { return std::vector<std::string>(); }
  absl::StatusOr<int64_t> schema_version() override;
  bool is_shared() const override { return true; }
  const std::string& name() const override { return address_.name; }
  /// True unless the connection was lost.
  bool is_connected() const { return connection_ != nullptr; }

  /// From now on every change is noted with a number in the table last_changes, which is there.
  absl::Status note_changes();

  /// Carries out a prepared statement with its parameters, each in PostgreSQL's binary form.
  absl::StatusOr<pqxx::result> execute_prepared(const std::string& sql, const std::vector<std::string>& parameters);

 private:
  /// Why the last failure may pass.
  enum class Failure { kNone, kConflict, kLost };
  using Clock = std::chrono::steady_clock;

  explicit PostgresDatabase(PostgresAddress address);
  absl::Status connect();
  /// Connects where there is no connection and nothing was begun with the one that there was.
  absl::Status reach();
  /// Does work with the connection, and notes what its failure was.
  template <typename Work>
  absl::Status guard(const Work& work);
  absl::Status note_loss(const std::string& why);
  absl::Status note_failure(const std::string& state, const std::string& message);
  /// OK where the change whose COMMIT was not answered was done.
  absl::Status ask_after_change();

  const PostgresAddress address_;
  std::unique_ptr<PostgresConnection> connection_;  ///< null while there is none
  int changes_ = 0;
  std::string session_;    ///< names this database's row in last_changes, in hex; empty: it has none
  int64_t n_changes_ = 0;  ///< begun so far
  bool is_begun_ = false;
  Access access_ = Access::kLook;  ///< of what is begun
  absl::Status begun_status_;      ///< the first error in what is begun
  Failure failure_ = Failure::kNone;
  Clock::time_point lost_at_{};      ///< when the connection was lost, if it is
  Clock::time_point retry_after_{};  ///< before this nobody tries to connect again
};

}  // namespace lipofill::server
