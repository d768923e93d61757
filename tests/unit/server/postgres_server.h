#pragma once

#include <sys/types.h>

#include <string>

namespace lipofill::testing {

/// A server of PostgreSQL 15 of the test's own: in a directory in /tmp, on a UNIX socket there that
/// this user alone reaches, and gone with this. As PostgreSQL refuses to run as root, it runs as
/// the user "postgres" then.
class PostgresServer {
 public:
  /// Makes the directory, with an empty database, and starts the server; fails the current test
  /// with a message when it does not come up.
  PostgresServer();
  ~PostgresServer();
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  /// The address of a new, empty schema, as lipofilld takes it.
  std::string make_place();
  /// The same schema over another UNIX socket, <directory>/.s.PGSQL.5432.
  static std::string through(const std::string& place, const std::string& directory);
  /// Carries out statements in the schema of an address.
  static void execute(const std::string& place, const std::string& sql);

  /// Starts it. It ends with the thread that starts it.
  void start();
  /// Ends it in order, its connections included.
  void stop();
  /// Ends it as a loss of power does: what was committed is there when it starts again.
  void crash();

  const std::string& directory() const { return directory_; }

  /// One for all tests of a program, started by whoever asks first.
  static PostgresServer& of_program();

 private:
  void run_to_end(const std::string& command) const;
  void end(int signal);

  std::string directory_;
  pid_t process_ = -1;
  int n_places_ = 0;
};

}  // namespace lipofill::testing
