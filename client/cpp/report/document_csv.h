#pragma once

#include <string>

#include "client/cpp/report/document.h"

namespace lipofill::client {

/// All figures of a report, a line each: section, table, row and column, the value unrounded in the
/// unit that is shown, and the field of the record that it comes from. Numbers have a decimal point
/// in every language. Checked by tests/unit/client/report_document_test.cc.
std::string document_csv(const ReportDocument& document);

}  // namespace lipofill::client
