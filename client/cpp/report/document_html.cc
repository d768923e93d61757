#include "client/cpp/report/document_html.h"

#include <charconv>
#include <string_view>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cpp/report/document_style.h"

namespace lipofill::client {
namespace {

std::string escaped(std::string_view text) {
  return absl::StrReplaceAll(absl::string_view(text.data(), text.size()),
                             {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

std::string attribute(const char* name, const std::string& value) {
  return value.empty() ? "" : absl::StrCat(" ", name, "=\"", escaped(value), "\"");
}

std::string shortest(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

std::string pieces_html(const std::vector<Piece>& pieces) {
  std::string html;
  for (const Piece& piece : pieces) {
    if (!piece.figure) {
      html += escaped(piece.text);
      continue;
    }
    absl::StrAppend(&html, "<data", attribute("value", shortest(piece.figure->value)),
                    attribute("data-field", piece.figure->field), attribute("data-unit", piece.figure->unit), ">",
                    escaped(piece.text), "</data>");
  }
  return html;
}

bool is_of_figures(const Cell& cell) {
  for (const Piece& piece : cell.pieces) {
    if (piece.figure) return true;
  }
  return false;
}

std::string header_row(const std::vector<std::string>& columns) {
  std::string html = "<thead><tr>";
  for (const std::string& column : columns) {
    absl::StrAppend(&html, "<th scope=\"col\">", escaped(column), "</th>");
  }
  return html + "</tr></thead>\n";
}

std::string cell_html(const Cell& cell, bool heads_row) {
  const char* tag = heads_row ? "th" : "td";
  std::string html =
      absl::StrCat("<", tag, heads_row ? " scope=\"row\"" : "",
                   is_of_figures(cell) && !heads_row ? " class=\"number\"" : "", attribute("lang", cell.language), ">");
  if (!cell.mark.empty()) absl::StrAppend(&html, "<span class=\"chip\" style=\"background:", cell.mark, "\"></span>");
  return absl::StrCat(html, pieces_html(cell.pieces), "</", tag, ">");
}

std::string image(const ReportPicture& picture) {
  return absl::StrCat("<img alt=\"", escaped(picture.alternative), "\" src=\"data:image/png;base64,",
                      absl::Base64Escape(picture.png), "\"/>");
}

/// A bar from left to right with five numbers below it.
std::string scale_html(const ColourScale& scale, Language language) {
  constexpr int kLabels = 5;
  constexpr double kWidth = 300.0;
  const auto at = [&](int k) { return scale.low + (scale.high - scale.low) * k / (kLabels - 1); };
  std::string html =
      absl::StrCat("<svg class=\"scale\" viewBox=\"-18 0 336 46\" role=\"img\"",
                   attribute("aria-label", absl::StrCat(scale.caption, " [", scale.unit,
                                                        "]: ", number_text(scale.low, scale.decimals, language),
                                                        " \u2013 ", number_text(scale.high, scale.decimals, language))),
                   ">");
  const double step = kWidth / static_cast<double>(scale.colours.size());
  for (size_t k = 0; k < scale.colours.size(); ++k) {
    absl::StrAppendFormat(&html, "<rect x=\"%.2f\" y=\"0\" width=\"%.2f\" height=\"14\" fill=\"%s\"/>",
                          step * static_cast<double>(k), step + 0.5, scale.colours[k]);
  }
  for (int k = 0; k < kLabels; ++k) {
    absl::StrAppendFormat(&html, "<text x=\"%.1f\" y=\"28\" text-anchor=\"middle\">%s</text>",
                          kWidth * k / (kLabels - 1), number_text(at(k), scale.decimals, language));
  }
  absl::StrAppendFormat(&html, "<text x=\"%.1f\" y=\"43\" text-anchor=\"middle\">%s [%s]</text></svg>", kWidth / 2,
                        escaped(scale.caption), escaped(scale.unit));
  return html;
}

/// Turns each kind of block into HTML.
class BlockWriter {
 public:
  explicit BlockWriter(Language language) : language_(language) {}

  std::string operator()(const Paragraph& text) const {
    return absl::StrCat("<p", attribute("lang", text.language), ">", pieces_html(text.pieces), "</p>\n");
  }

  std::string operator()(const BulletList& list) const {
    std::string html = absl::StrCat("<ul", attribute("lang", list.language), ">");
    for (const std::string& item : list.items) absl::StrAppend(&html, "<li>", escaped(item), "</li>");
    return html + "</ul>\n";
  }

  std::string operator()(const CodeLine& code) const {
    return absl::StrCat("<p><code>", escaped(code.text), "</code></p>\n");
  }

  std::string operator()(const Table& table) const {
    std::string html =
        absl::StrCat("<table", attribute("id", table.id), "><caption>", escaped(table.caption), "</caption>\n");
    html += header_row(table.columns) + "<tbody>\n";
    for (const std::vector<Cell>& row : table.rows) {
      html += "<tr>";
      for (size_t k = 0; k < row.size(); ++k) html += cell_html(row[k], k == 0);
      html += "</tr>\n";
    }
    return html + "</tbody></table>\n";
  }

  std::string operator()(const PictureTable& table) const {
    std::string html = absl::StrCat("<table class=\"pictures columns-", table.columns.size() - 1, "\"",
                                    attribute("id", table.id), "><caption>", escaped(table.caption), "</caption>\n");
    html += header_row(table.columns) + "<tbody>\n";
    for (const auto& [heading, pictures] : table.rows) {
      absl::StrAppend(&html, "<tr><th scope=\"row\">", escaped(heading), "</th>");
      for (const ReportPicture& picture : pictures) absl::StrAppend(&html, "<td>", image(picture), "</td>");
      html += "</tr>\n";
    }
    return html + "</tbody></table>\n";
  }

  std::string operator()(const Maps& maps) const {
    std::string html = "<div class=\"maps\">\n";
    for (const Map& map : maps.maps) {
      absl::StrAppend(&html, "<figure>", image(map.picture), "<figcaption>", escaped(map.caption), "</figcaption>");
      if (map.scale) html += scale_html(*map.scale, language_);
      if (!map.legend.empty()) html += "<ul class=\"legend\">";
      for (const auto& [colour, meaning] : map.legend) {
        absl::StrAppend(&html, "<li><span class=\"chip\" style=\"background:", colour, "\"></span>", escaped(meaning),
                        "</li>");
      }
      if (!map.legend.empty()) html += "</ul>";
      html += "</figure>\n";
    }
    return html + "</div>\n";
  }

 private:
  Language language_;
};

}  // namespace

std::string document_html(const ReportDocument& document) {
  std::string html = absl::StrCat(
      "<!DOCTYPE html>\n<html lang=\"", info_of(document.language).code, "\">\n<head>\n", "<meta charset=\"utf-8\"/>\n",
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>", escaped(document.title),
      "</title>\n<style>\n", document_style(document), "</style>\n</head>\n<body>\n<main>\n<h1>",
      escaped(document.title), "</h1>\n<p class=\"notice\">", escaped(document.notice), "</p>\n");
  const BlockWriter write(document.language);
  for (const Section& section : document.sections) {
    absl::StrAppend(&html, "<section", attribute("id", section.id), section.begins_page ? " class=\"page\"" : "",
                    "><h2>", escaped(section.heading), "</h2>\n");
    for (const Block& block : section.blocks) html += std::visit(write, block);
    html += "</section>\n";
  }
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace lipofill::client
