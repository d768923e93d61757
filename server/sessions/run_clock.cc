#include "server/sessions/run_clock.h"

namespace lipofill::server {

using Seconds = std::chrono::duration<double>;

void RunClock::begin(double simulated_s, Time now) {
  runs_ = true;
  since_ = now;
  since_simulated_s_ = simulated_s;
}

void RunClock::stop(Time now) {
  wall_before_s_ = wall_s(now);
  runs_ = false;
}

void RunClock::set_back(double wall_s) {
  runs_ = false;
  wall_before_s_ = wall_s;
}

double RunClock::wall_s(Time now) const {
  return runs_ ? wall_before_s_ + Seconds(now - since_).count() : wall_before_s_;
}

RunClock::Time RunClock::due_time(double simulated_s) const {
  return since_ + std::chrono::duration_cast<Clock::duration>(Seconds(simulated_s - since_simulated_s_));
}

}  // namespace lipofill::server
