#pragma once

#include <functional>

#include "client/cli/application.h"
#include "lipofill/v1/forecast_service.pb.h"

namespace lipofill::client {

/// Adds the commands that tell what is known of a plan, and what is left of fat.
void add_forecast_commands(CLI::App& root, Application& application);

/// Adds the options that fill a forecast's spec, --retention to --months-between.
/// @param spec  gives the message that they fill
void add_forecast_options(CLI::App& command, const std::function<v1::ForecastSpec*()>& spec);

}  // namespace lipofill::client
