#include "client/cli/private_daemon.h"

#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "client/cli/process.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr seconds kStartTime(20);
constexpr seconds kStopTime(15);
constexpr milliseconds kPoll(20);

std::string end_of_log(const std::filesystem::path& log) {
  constexpr size_t kMost = 2000;
  const std::string text = read_text_file(log).value_or("");
  return text.size() <= kMost ? text : text.substr(text.size() - kMost);
}

}  // namespace

absl::StatusOr<std::unique_ptr<PrivateDaemon>> PrivateDaemon::start(const std::filesystem::path& data,
                                                                    const std::stop_token& stop) {
  const std::filesystem::path program = find_program("lipofilld");
  if (program.empty())
    return absl::NotFoundError("no lipofilld beside lipofill or on PATH; build or install it, or use --server");
  std::error_code error;
  std::filesystem::create_directories(data, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", data.string(), ": ", error.message()));
  const std::filesystem::path port_file = data / "port";
  const std::filesystem::path log = data / "lipofilld.log";
  std::filesystem::remove(port_file, error);
  const auto process = start_process(
      {program.string(), "--listen", "127.0.0.1:0", "--data", data.string(), "--port-file", port_file.string()}, log,
      true);
  if (!process.ok()) return process.status();
  std::unique_ptr<PrivateDaemon> daemon(new PrivateDaemon(*process));
  if (auto status = daemon->wait_for_port(port_file, log, stop); !status.ok()) return status;
  return daemon;
}

bool PrivateDaemon::has_ended() {
  if (!ended_) ended_ = waitpid(process_, nullptr, WNOHANG) == process_;
  return ended_;
}

absl::Status PrivateDaemon::wait_for_port(const std::filesystem::path& port_file, const std::filesystem::path& log,
                                          const std::stop_token& stop) {
  const auto deadline = steady_clock::now() + kStartTime;
  while (steady_clock::now() < deadline) {
    std::ifstream stream(port_file);
    int port = 0;
    std::string line;
    // The daemon may be at writing it: only a whole line counts.
    if (std::getline(stream, line) && !stream.eof()) port = std::atoi(line.c_str());
    if (port > 0) {
      server_ = absl::StrCat("127.0.0.1:", port);
      return absl::OkStatus();
    }
    if (has_ended()) return absl::InternalError(absl::StrCat("lipofilld ended at its start:\n", end_of_log(log)));
    if (stop.stop_requested()) return absl::CancelledError("interrupted");
    std::this_thread::sleep_for(kPoll);
  }
  return absl::InternalError(
      absl::StrCat("lipofilld named no port within ", kStartTime.count(), " s:\n", end_of_log(log)));
}

PrivateDaemon::~PrivateDaemon() {
  if (has_ended()) return;
  kill(process_, SIGTERM);
  const auto deadline = steady_clock::now() + kStopTime;
  while (!has_ended() && steady_clock::now() < deadline) std::this_thread::sleep_for(kPoll);
  if (has_ended()) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

}  // namespace lipofill::client
