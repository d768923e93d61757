#include "client/cpp/report/document_csv.h"

#include <charconv>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"

namespace lipofill::client {
namespace {

std::string quoted(const std::string& text) {
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

/// The shortest that reads back to the same value.
std::string shortest(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

std::string words_of(const Cell& cell) {
  return absl::StrJoin(cell.pieces, "", [](std::string* out, const Piece& piece) { *out += piece.text; });
}

void add_figures(const Section& section, const std::string& table, const std::string& row, const std::string& column,
                 const std::vector<Piece>& pieces, std::string& csv) {
  for (const Piece& piece : pieces) {
    if (!piece.figure) continue;
    const Figure& figure = *piece.figure;
    absl::StrAppend(&csv, quoted(section.heading), ",", quoted(table), ",", quoted(row), ",", quoted(column), ",",
                    shortest(figure.value * figure.scale), ",", figure.unit, ",", figure.field, "\n");
  }
}

void add_table(const Section& section, const Table& table, std::string& csv) {
  for (const std::vector<Cell>& row : table.rows) {
    for (size_t k = 0; k < row.size(); ++k) {
      add_figures(section, table.caption, words_of(row.front()), table.columns[k], row[k].pieces, csv);
    }
  }
}

}  // namespace

std::string document_csv(const ReportDocument& document) {
  std::string csv = "section,table,row,column,value,unit,field\n";
  for (const Section& section : document.sections) {
    for (const Block& block : section.blocks) {
      if (const auto* table = std::get_if<Table>(&block)) add_table(section, *table, csv);
      if (const auto* text = std::get_if<Paragraph>(&block)) add_figures(section, "", "", "", text->pieces, csv);
    }
  }
  return csv;
}

}  // namespace lipofill::client
