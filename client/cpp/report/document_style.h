#pragma once

#include <string>

#include "client/cpp/report/document.h"

namespace lipofill::client {

/// The style sheet of a report: columns on a screen, and on paper pages of its size with a running
/// head and foot.
std::string document_style(const ReportDocument& document);

}  // namespace lipofill::client
