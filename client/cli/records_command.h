#pragma once

#include "client/cli/application.h"

namespace lipofill::client {

/// Adds `lipofill records`: results as DICOM, and the way to a PACS and from it.
void add_records_commands(CLI::App& root, Application& application);

/// Adds the commands that speak to a PACS, below the group of the records.
void add_pacs_commands(CLI::App& group, Application& application);

}  // namespace lipofill::client
