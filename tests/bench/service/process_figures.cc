#include "tests/bench/service/process_figures.h"

#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include "absl/strings/str_cat.h"

namespace lipofill::bench {
namespace {

std::string first_line(const std::string& path) {
  std::string line;
  std::getline(std::ifstream(path) >> std::ws, line);
  return line;
}

/// Nanoseconds a task was on a processor: finer than the ticks of /proc/PID/stat.
double cpu_s_of_task(const std::string& folder) {
  double nanoseconds = 0.0;
  std::ifstream(folder + "/schedstat") >> nanoseconds;
  return nanoseconds * 1e-9;
}

/// "worker" of "worker/3".
std::string without_number(const std::string& name) {
  return name.substr(0, name.find('/'));
}

/// User and system time, ended threads included: fields 14 and 15, counted after the name in
/// brackets.
double cpu_s_of_process(const std::string& folder) {
  const std::string line = first_line(folder + "/stat");
  const size_t after_name = line.rfind(')');
  if (after_name == std::string::npos) return 0.0;
  std::istringstream fields(line.substr(after_name + 1));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  double user = 0.0;
  double system = 0.0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

double resident_mb(const std::string& folder) {
  double total_pages = 0.0;
  double resident_pages = 0.0;
  std::ifstream(folder + "/statm") >> total_pages >> resident_pages;
  return resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

double clock_s(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double ProcessFigures::cpu_s_of_name(const std::string& name) const {
  const auto found = cpu_s_of.find(name);
  return found == cpu_s_of.end() ? 0.0 : found->second;
}

ProcessFigures read_process(pid_t process) {
  const std::string folder = absl::StrCat("/proc/", process);
  ProcessFigures figures;
  figures.cpu_s = cpu_s_of_process(folder);
  figures.resident_mb = resident_mb(folder);
  std::error_code error;
  for (const auto& task : std::filesystem::directory_iterator(folder + "/task", error)) {
    const std::string name = without_number(first_line(task.path() / "comm"));
    figures.cpu_s_of[name] += cpu_s_of_task(task.path());
    ++figures.threads_of_name[name];
    ++figures.threads;
  }
  return figures;
}

double process_cpu_s() {
  return clock_s(CLOCK_PROCESS_CPUTIME_ID);
}

double thread_cpu_s() {
  return clock_s(CLOCK_THREAD_CPUTIME_ID);
}

}  // namespace lipofill::bench
