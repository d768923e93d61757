#include "tests/integration/service/footprint.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "absl/strings/str_cat.h"

namespace lipofill::testing {

Footprint read_footprint(pid_t process) {
  Footprint footprint;
  const std::string proc = absl::StrCat("/proc/", process);
  std::ifstream status(proc + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("Threads:", 0) == 0) footprint.threads = std::atoi(line.c_str() + 8);
    if (line.rfind("VmRSS:", 0) == 0) footprint.resident_mb = std::atof(line.c_str() + 6) * 1024e-6;
  }
  for (const auto& entry : std::filesystem::directory_iterator(proc + "/fd")) {
    std::error_code gone;
    const std::string target = std::filesystem::read_symlink(entry.path(), gone).string();
    if (target.rfind("socket:", 0) == 0) ++footprint.sockets;
  }
  return footprint;
}

}  // namespace lipofill::testing
