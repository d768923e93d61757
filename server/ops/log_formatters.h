#pragma once

#include <spdlog/formatter.h>

#include <memory>

namespace lipofill::server {

/// The two shapes of a line, with the fields of the scopes of the thread that logs.
std::unique_ptr<spdlog::formatter> make_text_formatter();
std::unique_ptr<spdlog::formatter> make_json_formatter();

}  // namespace lipofill::server
