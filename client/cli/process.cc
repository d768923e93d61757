#include "client/cli/process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/cli/interrupt.h"

namespace lipofill::client {
namespace {

bool is_program(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0;
}

/// The variables of this program but for those that set up a daemon of somebody else's or are
/// between it and systemd.
std::vector<char*> environment_to_hand_on() {
  std::vector<char*> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const absl::string_view text(*variable);
    const bool of_a_daemon = absl::StartsWith(text, "LIPOFILLD_") || absl::StartsWith(text, "NOTIFY_SOCKET=") ||
                             absl::StartsWith(text, "WATCHDOG_");
    if (!of_a_daemon) variables.push_back(*variable);
  }
  variables.push_back(nullptr);
  return variables;
}

/// Turns the child into the program; it may make async-signal-safe calls only.
[[noreturn]] void become(char* const* arguments, char* const* environment, int log, pid_t parent, bool detached) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);
  if (detached) setpgid(0, 0);
  restore_signals_in_child();
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execve(arguments[0], arguments, environment);
  _exit(127);
}

}  // namespace

std::filesystem::path this_program() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error);
}

std::filesystem::path find_program(const std::string& name) {
  const std::filesystem::path beside = this_program().parent_path() / name;
  if (is_program(beside)) return beside;
  const char* path = std::getenv("PATH");
  for (const auto& folder : absl::StrSplit(path != nullptr ? path : "", ':', absl::SkipEmpty())) {
    const std::filesystem::path candidate = std::filesystem::path(std::string(folder)) / name;
    if (is_program(candidate)) return candidate;
  }
  return {};
}

absl::StatusOr<pid_t> start_process(const std::vector<std::string>& command, const std::filesystem::path& log,
                                    bool detached) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const int log_file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (log_file < 0) return absl::InternalError(absl::StrCat("cannot write ", log.string(), ": ", std::strerror(errno)));
  const std::vector<char*> environment = environment_to_hand_on();
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) become(arguments.data(), environment.data(), log_file, parent, detached);
  const int fork_error = errno;
  close(log_file);
  if (child < 0) return absl::InternalError(absl::StrCat("cannot start ", command[0], ": ", std::strerror(fork_error)));
  return child;
}

absl::StatusOr<int> run_process(const std::vector<std::string>& command, const std::filesystem::path& log) {
  const auto child = start_process(command, log, false);
  if (!child.ok()) return child.status();
  int result = 0;
  while (waitpid(*child, &result, 0) < 0) {
    if (errno != EINTR) return absl::InternalError(absl::StrCat("lost ", command[0]));
  }
  return WIFEXITED(result) ? WEXITSTATUS(result) : 128 + WTERMSIG(result);
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "lipofill-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

}  // namespace lipofill::client
