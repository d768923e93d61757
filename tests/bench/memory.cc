#include "tests/bench/memory.h"

#include <malloc.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "core/simulation/simulation.h"

namespace lipofill::bench {
namespace {

double read_status_mb(const std::string& key) {
  constexpr double kKibibytesPerMegabyte = 1e6 / 1024.0;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kibibytes = 0.0;
    if (word == key && status >> kibibytes) return kibibytes / kKibibytesPerMegabyte;
  }
  return 0.0;
}

}  // namespace

double resident_mb() {
  return read_status_mb("VmRSS:");
}
double peak_resident_mb() {
  return read_status_mb("VmHWM:");
}

void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

absl::StatusOr<SessionMemory> measure_session_memory(const JawAngle& jaw, int sessions, int steps) {
  std::vector<std::unique_ptr<simulation::Simulation>> running;
  const auto begin_one = [&]() -> absl::Status {
    auto created = simulation::Simulation::create(jaw.model, jaw.spec);
    if (!created.ok()) return created.status();
    for (int k = 0; k < steps; ++k) (*created)->advance_step();
    running.push_back(*std::move(created));
    return absl::OkStatus();
  };
  malloc_trim(0);
  const double before = resident_mb();
  for (int k = 0; k < sessions; ++k) {
    if (const absl::Status status = begin_one(); !status.ok()) return status;
  }
  malloc_trim(0);
  return SessionMemory{sessions, (resident_mb() - before) / sessions};
}

}  // namespace lipofill::bench
