#pragma once

#include <deque>
#include <functional>
#include <mutex>

namespace lipofill::server {

/// Commands for something that one thread at a time may act on. Whoever posts a command carries it
/// out at once when nobody acts; otherwise the one who acts does, at the latest when it is done.
/// Nobody waits for another. Commands are carried out one after the other in the order in which
/// they came, each once.
///
/// Checked by tests/unit/server/sessions/mailbox_test.cc.
class Mailbox {
 public:
  using Command = std::function<void()>;

  // These may be called by any thread.
  void post(Command command);
  bool empty() const;
  /// Waits until nobody else acts, carries out what is in the mailbox, then acts. What comes
  /// meanwhile is carried out after it.
  void act(const std::function<void()>& act);

  // These are for the one who acts.
  /// Puts a command behind those that wait, for instance to come after the answer to the one at
  /// hand.
  void queue(Command command);
  /// Carries out all that waits, between two things to do.
  void carry_out();
  /// Lays a command aside until one of the next two is called.
  void defer(Command command);
  void queue_deferred();
  void carry_out_deferred();

 private:
  void carry_out_when_idle();

  mutable std::mutex mutex_;
  std::deque<Command> waiting_;
  std::mutex acting_;  ///< held by the one who acts
  std::deque<Command> deferred_;
};

}  // namespace lipofill::server
