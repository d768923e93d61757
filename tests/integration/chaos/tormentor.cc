#include "tests/integration/chaos/tormentor.h"

#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"

namespace lipofill::testing {
namespace {

namespace fs = std::filesystem;

constexpr char kHealth[] = "/grpc.health.v1.Health/Check";
constexpr char kList[] = "/lipofill.v1.SimulationService/ListSimulations";

uint64_t open_files(pid_t process) {
  std::error_code error;
  uint64_t n = 0;
  for (const auto& file : fs::directory_iterator(absl::StrCat("/proc/", process, "/fd"), error)) {
    n += file.path().empty() ? 0 : 1;
  }
  return n;
}

/// The file is never there in part.
void write_whole(const std::string& file, const std::string& text) {
  std::ofstream(file + ".new") << text;
  fs::rename(file + ".new", file);
}

}  // namespace

void Tormentor::torment() {
  const auto what = static_cast<Torment>(pick(kTormentNames.size()));
  ++counts_[static_cast<size_t>(what)];
  last_ = kTormentNames[static_cast<size_t>(what)];
  const pid_t process = daemon_.pid();
  switch (what) {
    case Torment::kFullDisk:
      return limit(RLIMIT_FSIZE, 1);
    case Torment::kNoFiles:
      return limit(RLIMIT_NOFILE, open_files(process) + pick(3));
    case Torment::kNoMemory:
      return make_memory_scarce();
    case Torment::kClock:
      return set_clock();
    case Torment::kStandstill:
      return stand_still();
    case Torment::kDeafReader:
      return ask_and_not_read();
    default:
      return flood(what);
  }
}

void Tormentor::hold_on() {
  std::this_thread::sleep_for(std::chrono::milliseconds(50 + pick(250)));
}

/// Lowers a limit of the process for a moment.
void Tormentor::limit(int resource, uint64_t soft) {
  rlimit before{};
  const auto kind = static_cast<__rlimit_resource>(resource);
  if (::prlimit(daemon_.pid(), kind, nullptr, &before) != 0) return;
  const rlimit lower = {std::min<rlim_t>(soft, before.rlim_max), before.rlim_max};
  ::prlimit(daemon_.pid(), kind, &lower, nullptr);
  hold_on();
  ::prlimit(daemon_.pid(), kind, &before, nullptr);
}

/// By up to a day, back or forth.
void Tormentor::set_clock() {
  constexpr int64_t kDay = 86'400;
  const auto seconds = static_cast<int64_t>(pick(2 * kDay)) - kDay;
  write_whole(files_.clock, std::to_string(seconds));
}

void Tormentor::make_memory_scarce() {
  write_whole(files_.scarce, absl::StrCat(100'000 + 10'000 * pick(20), " ", 2 + pick(3)));
  hold_on();
  fs::remove(files_.scarce);
}

void Tormentor::stand_still() {
  ::kill(daemon_.pid(), SIGSTOP);
  hold_on();
  ::kill(daemon_.pid(), SIGCONT);
}

void Tormentor::ask_and_not_read() {
  auto client = std::make_unique<RawHttp2>(daemon_.port(), 0);
  for (uint32_t stream = 1; stream < 200; stream += 2) {
    if (!client->send(RawHttp2::whole_call(stream, kList, ""), 1.0)) break;
  }
  deaf_.push_back(std::move(client));
}

void Tormentor::flood(Torment what) {
  constexpr char kCancel[] = {0, 0, 0, 8};
  RawHttp2 client(daemon_.port());
  const std::string headers = RawHttp2::call_headers(kHealth);
  const int n = 500 + static_cast<int>(pick(2000));
  std::string frames;
  for (int i = 0; i < n; ++i) {
    const auto stream = static_cast<uint32_t>(2 * i + 1);
    if (what == Torment::kResets) {
      frames += RawHttp2::frame(FrameType::kHeaders, RawHttp2::kEndHeaders, stream, headers);
      frames += RawHttp2::frame(FrameType::kResetStream, 0, stream, std::string_view(kCancel, sizeof kCancel));
    } else if (what == Torment::kFrames) {
      frames += RawHttp2::frame(FrameType::kSettings, 0, 0, "");
      frames += RawHttp2::frame(FrameType::kPing, 0, 0, "12345678");
    } else {
      frames += i == 0 ? RawHttp2::frame(FrameType::kHeaders, 0, 1, headers)
                       : RawHttp2::frame(FrameType::kContinuation, 0, 1, std::string(1000, '\0'));
    }
  }
  client.send(frames, 0.3);
}

}  // namespace lipofill::testing
