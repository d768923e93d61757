#include "server/sessions/mailbox.h"

#include <utility>

namespace lipofill::server {

void Mailbox::post(Command command) {
  queue(std::move(command));
  carry_out_when_idle();
}

bool Mailbox::empty() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty();
}

void Mailbox::act(const std::function<void()>& act) {
  {
    const std::lock_guard lock(acting_);
    carry_out();
    act();
  }
  carry_out_when_idle();
}

void Mailbox::queue(Command command) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(command));
}

// Whoever fails to get the lock may leave: its holder looks at the mailbox again after letting go.
void Mailbox::carry_out_when_idle() {
  while (!empty()) {
    const std::unique_lock lock(acting_, std::try_to_lock);
    if (!lock.owns_lock()) return;
    carry_out();
  }
}

void Mailbox::carry_out() {
  while (true) {
    Command next;
    {
      const std::lock_guard lock(mutex_);
      if (waiting_.empty()) return;
      next = std::move(waiting_.front());
      waiting_.pop_front();
    }
    next();
  }
}

void Mailbox::defer(Command command) {
  deferred_.push_back(std::move(command));
}

void Mailbox::queue_deferred() {
  for (Command& command : std::exchange(deferred_, {})) queue(std::move(command));
}

void Mailbox::carry_out_deferred() {
  for (const Command& command : std::exchange(deferred_, {})) command();
}

}  // namespace lipofill::server
