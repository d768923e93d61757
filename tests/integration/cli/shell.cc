#include "tests/integration/cli/shell.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

namespace lipofill::testing {
namespace {

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

[[noreturn]] void become_shell(const std::string& line, const std::string& output, const std::string& errors) {
  unsetenv("LIPOFILL_SERVER");
  unsetenv("DISPLAY");
  const std::string path = std::string(LIPOFILL_BIN) + ":" + getenv("PATH");
  setenv("PATH", path.c_str(), 1);
  setpgid(0, 0);
  dup2(open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
  // exec: signals reach lipofill itself.
  execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
  _exit(127);
}

}  // namespace

CommandResult run_shell(const std::string& line) {
  return Command(line).wait();
}

Command::Command(const std::string& line) {
  std::string name = (std::filesystem::temp_directory_path() / "lipofill-shell-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) abort();
  folder_ = name;
  process_ = fork();
  if (process_ == 0) become_shell(line, folder_ / "out", folder_ / "err");
}

Command::~Command() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  std::filesystem::remove_all(folder_);
}

void Command::signal(int number) const {
  kill(process_, number);
}

CommandResult Command::wait() {
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = -1;
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contents(folder_ / "out"),
          contents(folder_ / "err")};
}

}  // namespace lipofill::testing
