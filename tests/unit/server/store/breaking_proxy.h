#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace lipofill::testing {

/// A UNIX socket in front of that of a PostgreSQL server, which passes on what comes and can lose a
/// connection at the worst moment.
class BreakingProxy {
 public:
  /// Listens in one directory and speaks to the server in the other.
  BreakingProxy(const std::string& directory, const std::string& server_directory);
  ~BreakingProxy();
  BreakingProxy(const BreakingProxy&) = delete;
  BreakingProxy& operator=(const BreakingProxy&) = delete;

  /// The next COMMIT reaches the server, and its answer does not come back.
  void lose_next_answer_to_commit() { loses_ = kAnswer; }
  /// The next COMMIT does not reach the server.
  void lose_next_commit() { loses_ = kCommit; }
  bool has_lost() const { return loses_ == kNothing; }

 private:
  enum Loss { kNothing, kAnswer, kCommit };

  void serve();
  void pass_on(int client, int server);

  const std::string server_socket_;
  int listening_ = -1;
  std::atomic<Loss> loses_ = kNothing;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace lipofill::testing
