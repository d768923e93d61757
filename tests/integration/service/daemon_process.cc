#include "tests/integration/service/daemon_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace lipofill::testing {
namespace {

using Clock = std::chrono::steady_clock;

pid_t start(std::vector<std::string> arguments, const std::string& log) {
  arguments.insert(arguments.begin(), LIPOFILLD);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t process = ::fork();
  if (process == 0) {
    const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::dup2(file, 1);
    ::dup2(file, 2);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  return process;
}

std::string read_file(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The arguments of a daemon on a free port, with two workers unless they say otherwise.
std::vector<std::string> all_arguments(const std::string& data, const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {"--listen", "127.0.0.1:0", "--data", data, "--port-file", data + ".port"};
  if (std::find(arguments.begin(), arguments.end(), "--workers") == arguments.end()) {
    all.insert(all.end(), {"--workers", "2"});
  }
  all.insert(all.end(), arguments.begin(), arguments.end());
  return all;
}

int exit_code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

DaemonProcess::DaemonProcess(const std::string& data, const std::vector<std::string>& arguments)
    : log_file_(data + ".log") {
  const std::string port_file = data + ".port";
  std::filesystem::remove(port_file);
  process_ = start(all_arguments(data, arguments), log_file_);
  const Clock::time_point deadline = Clock::now() + std::chrono::seconds(30);
  while (port_ == 0 && running() && Clock::now() < deadline) {
    std::ifstream(port_file) >> port_;
    int status = 0;
    if (::waitpid(process_, &status, WNOHANG) == process_) process_ = -1;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_NE(port_, 0) << "lipofilld does not serve:\n" << log();
}

void DaemonProcess::start_and_kill(const std::string& data, const std::vector<std::string>& arguments,
                                   std::chrono::milliseconds lifetime) {
  const pid_t process = start(all_arguments(data, arguments), data + ".log");
  std::this_thread::sleep_for(lifetime);
  ::kill(process, SIGKILL);
  ::waitpid(process, nullptr, 0);
}

DaemonProcess::~DaemonProcess() {
  if (running()) kill_hard();
}

void DaemonProcess::signal(int number) const {
  if (running()) ::kill(process_, number);
}

int DaemonProcess::wait(double timeout_s) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(timeout_s);
  while (running() && Clock::now() < deadline) {
    int status = 0;
    if (::waitpid(process_, &status, WNOHANG) == process_) {
      process_ = -1;
      return exit_code_of(status);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return -1;
}

int DaemonProcess::terminate() {
  signal(SIGTERM);
  return wait();
}

void DaemonProcess::kill_hard() {
  signal(SIGKILL);
  wait();
}

std::string DaemonProcess::log() const {
  return read_file(log_file_);
}

int run_daemon_to_end(const std::vector<std::string>& arguments, std::string& output) {
  std::string log = (std::filesystem::temp_directory_path() / "lipofilld_XXXXXX").string();
  ::close(::mkstemp(log.data()));
  int status = 0;
  ::waitpid(start(arguments, log), &status, 0);
  output = read_file(log);
  std::filesystem::remove(log);
  return exit_code_of(status);
}

}  // namespace lipofill::testing
