#pragma once

#include <atomic>
#include <memory>

#include "server/sessions/courier.h"
#include "server/sessions/session.h"

namespace lipofill::server {

/// A look at a session that does not wait for its step: the figures as they are now, or where the
/// step takes longer than half a second, those after the last one. A settled shape that is found
/// directly is a single step, which may take a minute.
/// Checked by tests/integration/service/run_test.cc.
class TimelyLook : public Courier::Stream, public std::enable_shared_from_this<TimelyLook> {
 public:
  /// Looks, and replies once.
  static void begin(Courier& courier, std::shared_ptr<Session> session, Session::Reply reply);

  TimelyLook(Courier& courier, std::shared_ptr<Session> session, Session::Reply reply)
      : courier_(courier), session_(std::move(session)), reply_(std::move(reply)) {}

  /// The time is over. Figures of an end are answered as they are then, with the hash of its state.
  void deliver() override;

 private:
  void answer(const absl::StatusOr<SessionView>& view);

  Courier& courier_;
  const std::shared_ptr<Session> session_;
  const Session::Reply reply_;
  std::atomic<bool> is_answered_ = false;
};

}  // namespace lipofill::server
