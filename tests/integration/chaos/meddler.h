#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace lipofill::testing {

/// Spoils files of a data directory while no daemon runs on it: takes them away, puts older ones in
/// their place, flips bits in them. It spoils the daemon's own checkpoints alone, which it can do
/// without: there are earlier ones, and the plan with its log.
class Meddler {
 public:
  Meddler(std::filesystem::path data, uint64_t seed) : data_(std::move(data)), random_(seed) {}

  /// Spoils a file, if there is one.
  void meddle();
  int removed() const { return removed_; }
  int replaced() const { return replaced_; }
  int flipped() const { return flipped_; }

 private:
  std::vector<std::filesystem::path> automatic_checkpoints() const;
  void replace(const std::filesystem::path& file);
  void flip_bit(const std::filesystem::path& file);

  const std::filesystem::path data_;
  std::mt19937_64 random_;
  int removed_ = 0;
  int replaced_ = 0;
  int flipped_ = 0;
};

}  // namespace lipofill::testing
