#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// What a target does with one input: it returns 0, or it has found a defect. libFuzzer calls it
/// with inputs it makes up; replay.cc with those of the corpus.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace lipofill::fuzz {

inline std::string_view as_text(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Stops the program where what a target promises does not hold.
void require(bool holds, const char* promise);

/// A file of a name for readers that take files; gone with the program.
std::filesystem::path write_scratch_file(const std::string& name, std::string_view bytes);

}  // namespace lipofill::fuzz
