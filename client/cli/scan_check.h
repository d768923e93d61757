#pragma once

#include "client/cli/application.h"

namespace lipofill::client {

/// Adds `lipofill scan check`: what a file has, what of it is passed over, and what a model will
/// mend. Checked by tests/integration/cli/scan_check_test.cc.
void add_scan_check_command(CLI::App& scan, Application& application);

/// Adds `lipofill scan landmarks`: what a landmark file is understood as, and the same for other
/// programs. Checked by tests/integration/cli/scan_check_test.cc.
void add_scan_landmarks_command(CLI::App& scan, Application& application);

}  // namespace lipofill::client
