#pragma once

#include <string>

#include "client/cpp/report/document.h"

namespace lipofill::client {

/// A report as one HTML file that needs no other: pictures are in it, a style for screen and paper,
/// and no script. It is also well-formed XML. For people who do not see it: the language of every
/// text, one tree of headings, captions and header cells with their scope at every table, words for
/// every picture. A figure is <data value data-field data-unit>: the value in the record of the
/// report, where it stands there, and the unit that the words beside it are in. Equal documents
/// give equal bytes. Checked by tests/unit/client/report_document_test.cc.
std::string document_html(const ReportDocument& document);

}  // namespace lipofill::client
