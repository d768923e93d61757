#pragma once

#include "client/cli/application.h"

namespace lipofill::client {

/// Adds `lipofill thickness`. Checked by tests/python/test_thickness.py.
void add_thickness_command(CLI::App& root, Application& application);

}  // namespace lipofill::client
