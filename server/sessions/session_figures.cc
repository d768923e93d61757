// The figures of a session: its view between two steps, and the rows of its series on their way to
// the sink.

#include <algorithm>
#include <iterator>

#include "server/sessions/session.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr size_t kSeriesChunk = 500;
/// Rows that wait for room in the store; more are lost.
constexpr size_t kMostPending = 100'000;

double median(std::vector<float> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void Session::record_step(double wall_ms) {
  step_ms_.push_back(static_cast<float>(wall_ms));
  cost_.add(simulation_->report().cost);
  update_view();
  size_t n_pending = 0;
  {
    const std::lock_guard lock(view_mutex_);
    pending_.push_back({simulation_->report(), wall_ms});
    n_pending = pending_.size();
  }
  sink_.stepped({simulation_->report(), wall_ms});
  if (n_pending % kSeriesChunk != 0) return;
  if (const absl::Status kept = flush_series(); !kept.ok()) {
    spdlog::error("simulations/{}: {} rows of its series wait: {}", options_.id, n_pending, kept.ToString());
  }
  if (n_pending < kMostPending) return;
  spdlog::error("simulations/{}: {} rows of its series are lost", options_.id, n_pending);
  forget_pending(n_pending);
}

// Rows leave `pending_` only once they are in the sink, so that a reader who looks here first and there next misses
// none.
absl::Status Session::flush_series() {
  const std::vector<SeriesEntry> rows = pending_series(0);
  if (rows.empty()) return absl::OkStatus();
  if (const absl::Status kept = sink_.append_series(options_.id, rows); !kept.ok()) return kept;
  forget_pending(rows.size());
  return absl::OkStatus();
}

void Session::forget_pending(size_t n_rows) {
  const std::lock_guard lock(view_mutex_);
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(n_rows));
}

void Session::update_view() {
  std::vector<simulation::ZoneReport> zones = simulation_->zone_reports();
  std::vector<simulation::LigamentReport> ligaments = simulation_->ligament_reports();
  std::vector<std::string> remarks = simulation_->remarks();
  double wall_s = wall_before_s_;
  if (clock_runs_) wall_s += std::chrono::duration<double>(Clock::now() - running_since_).count();
  const std::lock_guard lock(view_mutex_);
  view_.report = simulation_->report();
  view_.zones = std::move(zones);
  view_.ligaments = std::move(ligaments);
  view_.remarks = std::move(remarks);
  view_.wall_s = wall_s;
  view_.cost = cost_;
}

/// Shows these figures from now on, when there is no simulation to take them from.
void Session::show_figures(SessionView view) {
  const std::lock_guard lock(view_mutex_);
  view_ = std::move(view);
}

SessionView Session::full_view() {
  if (simulation_ != nullptr) update_view();
  SessionView view = cached_view();
  if (simulation_ != nullptr) view.state_hash = simulation_->state_hash();
  view.step_ms_median = median(step_ms_);
  return view;
}

SessionView Session::cached_view() const {
  const std::lock_guard lock(view_mutex_);
  SessionView view = view_;
  view.viewers = watching_;
  view.queue_position = workers_.queue_position(*this);
  return view;
}

std::vector<SeriesEntry> Session::pending_series(uint64_t after_step) const {
  const std::lock_guard lock(view_mutex_);
  std::vector<SeriesEntry> rows;
  std::copy_if(pending_.begin(), pending_.end(), std::back_inserter(rows),
               [after_step](const SeriesEntry& row) { return row.report.step > after_step; });
  return rows;
}

}  // namespace lipofill::server
