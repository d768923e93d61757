#pragma once

#include "client/cli/application.h"

namespace lipofill::client {

/// Adds `lipofill scene`: a result as a scene for other programs.
void add_scene_command(CLI::App& root, Application& application);

}  // namespace lipofill::client
