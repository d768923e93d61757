#include "client/cpp/report/document_style.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/substitute.h"

namespace lipofill::client {
namespace {

constexpr char kStyle[] = R"(:root { color-scheme: light; }
body { font: 10.5pt/1.4 "DejaVu Sans", "Liberation Sans", Arial, sans-serif; color: #1c1c20; background: #fff; margin: 0; }
main { max-width: 190mm; margin: 0 auto; padding: 4mm; }
h1 { font-size: 19pt; line-height: 1.2; margin: 0 0 2mm; }
h2 { font-size: 14pt; margin: 7mm 0 2mm; border-bottom: 0.4mm solid #55606e; padding-bottom: 0.6mm; break-after: avoid; }
p { margin: 1.5mm 0; }
.notice { font-weight: bold; border: 0.5mm solid #1c1c20; padding: 1.5mm 3mm; }
table { border-collapse: collapse; width: 100%; margin: 2mm 0 4mm; font-size: 9pt; }
caption { text-align: left; font-weight: bold; padding-bottom: 1mm; break-after: avoid; }
th, td { text-align: left; vertical-align: top; padding: 0.7mm 1.6mm; border-bottom: 0.15mm solid #b9bfc7; overflow-wrap: anywhere; }
thead th { border-bottom: 0.4mm solid #55606e; vertical-align: bottom; overflow-wrap: normal; }
tbody th { font-weight: normal; overflow-wrap: break-word; }
tr { break-inside: avoid; }
td.number { font-variant-numeric: tabular-nums; }
ul { margin: 1.5mm 0; padding-left: 6mm; }
code { font: 8.5pt/1.4 "DejaVu Sans Mono", monospace; overflow-wrap: anywhere; }
.chip { display: inline-block; width: 3.2mm; height: 3.2mm; border: 0.2mm solid #1c1c20; margin-right: 1.5mm; vertical-align: -0.4mm; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
table.pictures { table-layout: fixed; }
table.pictures th, table.pictures td { padding: 0.4mm; border: 0; text-align: center; vertical-align: middle; }
table.pictures tbody th, table.pictures thead th:first-child { width: 17mm; text-align: left; font-size: 8.5pt; }
table.pictures img { max-height: 41mm; max-width: 100%; vertical-align: bottom; }
.maps { display: flex; flex-wrap: wrap; gap: 3mm; }
.maps figure { margin: 0; width: calc(50% - 1.5mm); break-inside: avoid; }
.maps img { width: 100%; }
figcaption { font-size: 9pt; font-weight: bold; }
.scale { width: 100%; height: auto; font-size: 11px; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
.legend { list-style: none; padding: 0; font-size: 9pt; columns: 2; }
@media print { main { max-width: none; padding: 0; } .page { break-before: page; } .page > h2 { margin-top: 0; } }
@page { size: $0; margin: 17mm 14mm 16mm;
  @top-left { content: "$1"; font: 8pt "DejaVu Sans", Arial, sans-serif; color: #3d4450; }
  @bottom-left { content: "$2"; font: 8pt "DejaVu Sans", Arial, sans-serif; color: #3d4450; }
  @bottom-right { content: "$3"; font: 8pt "DejaVu Sans", Arial, sans-serif; color: #3d4450; } }
)";

/// Text between quotation marks of a style sheet that stands in HTML.
std::string css_text(const std::string& text) {
  return absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"\"", "\\22 "}, {"<", "\\3c "}, {"&", "\\26 "}, {"\n", " "}});
}

}  // namespace

std::string document_style(const ReportDocument& document) {
  const std::string pages = absl::Substitute(css_text(document.page_of), "\" counter(page) \"", "\" counter(pages) \"");
  return absl::Substitute(kStyle, document.paper == Paper::kA4 ? "A4" : "letter", css_text(document.running_head),
                          css_text(document.notice), pages);
}

}  // namespace lipofill::client
