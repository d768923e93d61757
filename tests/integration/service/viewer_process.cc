#include "tests/integration/service/viewer_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

namespace lipofill::testing {

ViewerProcess::ViewerProcess(const std::string& server, const std::string& simulation, bool every, std::string output)
    : output_(std::move(output)) {
  std::vector<std::string> arguments = {LIPOFILL, "watch", simulation, "--server", server};
  if (every) arguments.push_back("--every");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  process_ = ::fork();
  if (process_ != 0) return;
  const int file = ::open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(file, 1);
  ::dup2(file, 2);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

ViewerProcess::~ViewerProcess() {
  signal(SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

void ViewerProcess::signal(int number) const {
  ::kill(process_, number);
}

bool ViewerProcess::await_frame() const {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::chrono::steady_clock::now() < deadline) {
    std::error_code error;
    if (const auto size = std::filesystem::file_size(output_, error); !error && size > 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace lipofill::testing
