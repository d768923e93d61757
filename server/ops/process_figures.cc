#include "server/ops/process_figures.h"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace lipofill::server {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double read_resident_bytes() {
  double pages_in_all = 0.0;
  double pages_resident = 0.0;
  std::ifstream("/proc/self/statm") >> pages_in_all >> pages_resident;
  return pages_resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

double count_entries(const char* directory) {
  std::error_code error;
  double count = 0.0;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    count += 1.0;
  }
  return count;
}

}  // namespace

ProcessFigures read_process_figures() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return {read_resident_bytes(), seconds(usage.ru_utime) + seconds(usage.ru_stime), count_entries("/proc/self/task"),
          count_entries("/proc/self/fd")};
}

void add_process_metrics(Metrics& metrics) {
  auto& resident = metrics.add_gauge("process_resident_memory_bytes", "Memory of the daemon that is in the machine's");
  auto& threads = metrics.add_gauge("process_threads", "Threads of the daemon");
  auto& files = metrics.add_gauge("process_open_fds", "Files and connections that the daemon holds open");
  auto& cpu = metrics.add_counter("process_cpu_seconds_total", "Processor time that the daemon has used");
  metrics.add_gauge("process_start_time_seconds", "When the daemon started, seconds since 1970").SetToCurrentTime();
  metrics.add_gauge("lipofill_build_info", "1; the labels say which build", {{"version", LIPOFILL_VERSION}}).Set(1);
  metrics.add_refresh([&resident, &threads, &files, &cpu] {
    const ProcessFigures figures = read_process_figures();
    resident.Set(figures.resident_bytes);
    threads.Set(figures.threads);
    files.Set(figures.open_files);
    cpu.Increment(figures.cpu_s - cpu.Value());
  });
}

}  // namespace lipofill::server
