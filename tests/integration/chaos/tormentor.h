#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/integration/chaos/chaos_daemon.h"
#include "tests/integration/security/raw_http2.h"

namespace lipofill::testing {

/// What may befall a daemon that goes on living.
enum class Torment { kFullDisk, kNoFiles, kNoMemory, kClock, kStandstill, kDeafReader, kResets, kFrames, kHeaders };
constexpr std::array<const char*, 9> kTormentNames = {"full disk",   "no descriptors", "no memory",
                                                      "clock steps", "standstills",    "deaf readers",
                                                      "resets",      "frames",         "headers"};

/// Has one thing after the other befall the daemon that lives, in seeded order, each for a moment:
/// the disk is full, no file can be opened, large allocations fail, the clock of the wall is
/// set by hours, the process stands still, clients do not read what they ask for or flood a
/// connection.
class Tormentor {
 public:
  /// The files are read by libraries that the daemon loads before others.
  struct Files {
    std::string clock;   ///< by how many seconds its clock is ahead (security/moved_clock.cc)
    std::string scarce;  ///< which allocations fail (service/scarce_memory.cc)
  };
  Tormentor(ChaosDaemon& daemon, uint64_t seed, Files files)
      : daemon_(daemon), random_(seed), files_(std::move(files)) {}

  /// Does one of them to the daemon, which must live until it returns.
  void torment();
  /// Lets go of clients that do not read.
  void let_go() { deaf_.clear(); }
  /// The name of the last of them.
  const char* last() const { return last_; }
  int count(Torment what) const { return counts_[static_cast<size_t>(what)]; }

 private:
  void limit(int resource, uint64_t soft);
  void set_clock();
  void make_memory_scarce();
  void stand_still();
  void ask_and_not_read();
  void flood(Torment what);
  void hold_on();
  uint64_t pick(uint64_t n) { return random_() % n; }

  ChaosDaemon& daemon_;
  std::mt19937_64 random_;
  const Files files_;
  std::vector<std::unique_ptr<RawHttp2>> deaf_;
  std::array<int, kTormentNames.size()> counts_{};
  const char* last_ = "nothing";
};

}  // namespace lipofill::testing
