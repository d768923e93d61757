#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lipofill {

/// SHA-256 over a sequence of values, for the names of immutable things and for proving that two
/// runs are the same to the byte. Numbers enter as their bytes in memory (little-endian on every
/// machine the project supports). Checked by tests/unit/base/base_test.cc against FIPS 180-4.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  void add_bytes(const void* data, size_t size);
  void add(std::string_view text);
  template <typename T>
  requires std::is_arithmetic_v<T>
  void add(T value) { add_bytes(&value, sizeof value); }
  template <typename T>
  requires std::is_arithmetic_v<T>
  void add(const std::vector<T>& values) {
    add(static_cast<uint64_t>(values.size()));
    add_bytes(values.data(), values.size() * sizeof(T));
  }

  /// Lower-case hex, 64 characters. Ends the sequence.
  std::string hex_digest();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lipofill
