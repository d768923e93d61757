#pragma once

#include "absl/status/status.h"

namespace lipofill::client {

/// Exit codes for the shell; documented in `lipofill --help`, and stable.
enum class ExitCode {
  kOk = 0,
  kGoalNotReached = 1,
  kBadInput = 2,
  kNoDaemon = 3,
  kNotPossible = 4,
  kInternal = 5,
  kInterrupted = 130,
};

inline constexpr char kExitCodeHelp[] =
    "Exit codes:\n"
    "  0    done\n"
    "  1    the simulation FAILED, or the run did not reach its goal\n"
    "  2    usage, or input that is refused (a plan, a scan, a value)\n"
    "  3    the daemon is not reachable\n"
    "  4    not found, not allowed, or not possible in the present state\n"
    "  5    an internal error\n"
    "  130  interrupted\n";

/// Returns the exit code of an error. Checked, from the shell, by tests/integration/cli/.
ExitCode exit_code_of(const absl::Status& status);

}  // namespace lipofill::client
