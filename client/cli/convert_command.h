#pragma once

#include "client/cli/application.h"

namespace lipofill::client {

/// Adds `lipofill scan convert`: files of other programs as files that a scan is read from.
void add_convert_command(CLI::App& scan, Application& application);

}  // namespace lipofill::client
