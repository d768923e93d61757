#pragma once

#include "client/cli/application.h"

namespace lipofill::client {

/// Adds the commands that tell what is known of a plan, and what is left of fat.
void add_forecast_commands(CLI::App& root, Application& application);

}  // namespace lipofill::client
