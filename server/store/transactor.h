#pragma once

#include <mutex>
#include <type_traits>

#include "absl/status/status.h"
#include "server/store/database.h"

namespace lipofill::server {

/// Carries out work on a database, one caller after the other, each as a transaction of its own.
/// Work returns a Status or a StatusOr; nothing it wrote stays when that is not OK. Work that
/// failed because another daemon was quicker, or because the connection was lost before anything
/// was done, is done again from its beginning. Thread-safe.
/// Checked by tests/unit/server/store/postgres_database_test.cc.
class Transactor {
 public:
  explicit Transactor(Database& database) : database_(database) {}

  template <typename Work>
  std::invoke_result_t<Work> transact(const Work& work) {
    return repeat(Access::kChange, work);
  }
  /// The same for work that writes nothing: it sees the store as it is at one moment.
  template <typename Work>
  std::invoke_result_t<Work> look(const Work& work) {
    return repeat(Access::kLook, work);
  }

 private:
  template <typename Work>
  std::invoke_result_t<Work> repeat(Access access, const Work& work) {
    const std::lock_guard lock(mutex_);
    for (int attempt = 0;; ++attempt) {
      auto done = attempt_once(access, work);
      if (done.ok() || !database_.may_try_again(attempt)) return done;
    }
  }
  template <typename Work>
  std::invoke_result_t<Work> attempt_once(Access access, const Work& work) {
    Transaction transaction(database_, access);
    if (!transaction.status().ok()) return transaction.status();
    auto done = work();
    if (!done.ok()) return done;
    if (const absl::Status kept = transaction.commit(); !kept.ok()) return kept;
    return done;
  }

  Database& database_;
  std::mutex mutex_;
};

}  // namespace lipofill::server
