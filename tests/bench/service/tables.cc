#include "tests/bench/service/tables.h"

#include "absl/strings/str_format.h"

namespace lipofill::bench {
namespace {

double ms_per_step(double seconds, double steps) {
  return steps > 0.0 ? 1e3 * seconds / steps : 0.0;
}

}  // namespace

Json show(const std::vector<SessionsRow>& rows) {
  absl::FPrintF(stderr, "%8s %8s %9s %9s %9s %10s %10s %6s %8s %9s %9s %8s\n", "sessions", "workers", "steps/s",
                "a session", "fairness", "worker ms", "daemon ms", "busy", "threads", "made MB", "run MB", "left MB");
  Json json = Json::array();
  for (const SessionsRow& row : rows) {
    const double rate = row.steps / row.wall_s;
    const double worker_ms = ms_per_step(row.worker_cpu_s, row.steps);
    const double daemon_ms = ms_per_step(row.daemon_cpu_s, row.steps);
    absl::FPrintF(stderr, "%8d %8d %9.1f %9.1f %9.3f %10.2f %10.2f %6.2f %8d %9.1f %9.1f %8.1f\n", row.sessions,
                  row.workers, rate, rate / row.sessions, row.fairness, worker_ms, daemon_ms,
                  row.worker_cpu_s / row.wall_s, row.threads, row.created_mb_a_session, row.running_mb_a_session,
                  row.left_mb);
    json.push_back({{"sessions", row.sessions},
                    {"workers", row.workers},
                    {"steps_per_s", rate},
                    {"steps_per_s_per_session", rate / row.sessions},
                    {"fairness", row.fairness},
                    {"worker_cpu_ms_per_step", worker_ms},
                    {"daemon_cpu_ms_per_step", daemon_ms},
                    {"workers_busy", row.worker_cpu_s / row.wall_s},
                    {"threads", row.threads},
                    {"idle_mb", row.idle_mb},
                    {"created_mb_per_session", row.created_mb_a_session},
                    {"running_mb_per_session", row.running_mb_a_session},
                    {"left_mb", row.left_mb},
                    {"state_hash", row.state_hash}});
  }
  return json;
}

Json show(const std::vector<ViewersRow>& rows) {
  absl::FPrintF(stderr, "%8s %6s %9s %10s %9s %13s %9s %9s\n", "viewers", "steps", "steps/s", "worker ms", "of first",
                "transport ms", "frames", "sent MB");
  Json json = Json::array();
  for (const ViewersRow& row : rows) {
    const double worker_ms = ms_per_step(row.worker_cpu_s, row.steps);
    const double of_first = worker_ms / ms_per_step(rows.front().worker_cpu_s, rows.front().steps);
    const double transport_ms = ms_per_step(row.transport_cpu_s, row.steps);
    absl::FPrintF(stderr, "%8d %6.0f %9.1f %10.2f %9.3f %13.2f %9.1f %9.1f\n", row.viewers, row.steps,
                  row.steps / row.wall_s, worker_ms, of_first, transport_ms, row.frames, row.sent_mb);
    json.push_back({{"viewers", row.viewers},
                    {"steps", row.steps},
                    {"steps_per_s", row.steps / row.wall_s},
                    {"worker_cpu_ms_per_step", worker_ms},
                    {"worker_cpu_of_first_row", of_first},
                    {"transport_cpu_ms_per_step", transport_ms},
                    {"frames_per_viewer", row.frames},
                    {"sent_mb", row.sent_mb}});
  }
  return json;
}

Json show(const std::string& what, const StartupTable& table) {
  absl::FPrintF(stderr, "%s, %d triangles: first frame after %.0f ms\n", what, table.triangles, table.first_frame_ms());
  Json phases = Json::array();
  for (const Phase& phase : table.phases) {
    absl::FPrintF(stderr, "  %-28s %9.1f ms, %9.1f ms of it computing here\n", phase.name, phase.wall_ms, phase.cpu_ms);
    phases.push_back({{"phase", phase.name}, {"wall_ms", phase.wall_ms}, {"cpu_ms", phase.cpu_ms}});
  }
  return {{"triangles", table.triangles},
          {"first_frame_ms", table.first_frame_ms()},
          {"phases", phases},
          {"state_hash", table.state_hash}};
}

}  // namespace lipofill::bench
