#include "server/simulations/timely_look.h"

#include <utility>

namespace lipofill::server {
namespace {

constexpr std::chrono::milliseconds kPatience{500};

}  // namespace

void TimelyLook::begin(Courier& courier, std::shared_ptr<Session> session, Session::Reply reply) {
  const auto look = std::make_shared<TimelyLook>(courier, std::move(session), std::move(reply));
  courier.wake_at(look, Courier::Clock::now() + kPatience);
  // The session keeps the look until it has answered.
  look->session_->inspect([look](const absl::StatusOr<SessionView>& view) { look->answer(view); });
}

void TimelyLook::deliver() {
  const SessionView view = session_->cached_view();
  if (!has_ended(view.state)) answer(view);
}

void TimelyLook::answer(const absl::StatusOr<SessionView>& view) {
  if (is_answered_.exchange(true)) return;
  courier_.forget(weak_from_this());
  reply_(view);
}

}  // namespace lipofill::server
