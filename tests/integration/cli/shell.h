#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lipofill::testing {

/// What a command left.
struct CommandResult {
  int exit_code = -1;  ///< 128 + the signal that ended it
  std::string output;
  std::string errors;
};

/// Runs a line in a shell, `lipofill` being the real binary and `lipofilld` beside it. Its
/// variables LIPOFILL_SERVER and DISPLAY are those named in the line only.
CommandResult run_shell(const std::string& line);

/// A shell line on its way; for what must be interrupted.
class Command {
 public:
  explicit Command(const std::string& line);
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  void signal(int number) const;
  CommandResult wait();

 private:
  std::filesystem::path folder_;
  pid_t process_ = -1;
};

}  // namespace lipofill::testing
