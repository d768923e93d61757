#include "tests/fuzz/target.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace lipofill::fuzz {
namespace {

struct ScratchFolder {
  std::filesystem::path path;
  ScratchFolder() : path(std::filesystem::temp_directory_path() / ("lipofill-fuzz-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

}  // namespace

void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: does not hold: %s\n", promise);
  std::abort();
}

std::filesystem::path write_scratch_file(const std::string& name, std::string_view bytes) {
  static const ScratchFolder folder;
  const std::filesystem::path file = folder.path / name;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

}  // namespace lipofill::fuzz
