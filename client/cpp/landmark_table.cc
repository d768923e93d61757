// Landmark files that are tables of text: .csv and the like, and the .fcsv of 3D Slicer.

#include <algorithm>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "client/cpp/landmark_formats.h"

namespace lipofill::client {
namespace {

using Row = std::vector<std::string>;

absl::Status wrong_at(size_t line, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("line ", line, ": ", what));
}

/// The lines of a text, ended by LF, CR LF or CR.
std::vector<std::string> split_lines(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::string unified =
      absl::StrReplaceAll(absl::string_view(text.data(), text.size()), {{"\r\n", "\n"}, {"\r", "\n"}});
  return absl::StrSplit(unified, '\n');
}

/// The cells of a line; one in quotation marks may hold the separator, and a doubled mark.
Row split_cells(const std::string& line, char separator) {
  Row row(1);
  bool quoted = false;
  for (size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"' && quoted && k + 1 < line.size() && line[k + 1] == '"') {
      row.back() += line[++k];
    } else if (line[k] == '"') {
      quoted = !quoted;
    } else if (line[k] == separator && !quoted) {
      row.emplace_back();
    } else {
      row.back() += line[k];
    }
  }
  for (std::string& cell : row) absl::StripAsciiWhitespace(&cell);
  return row;
}

std::optional<double> to_number(std::string text, char separator) {
  if (separator != ',') std::replace(text.begin(), text.end(), ',', '.');
  double value = 0.0;
  if (!absl::SimpleAtod(text, &value) || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Says which column has the names and which have the coordinates.
struct Columns {
  int name = -1;
  std::array<int, 3> xyz{-1, -1, -1};
  int placed = -1;  ///< 0 in it: the point is not placed
  std::optional<double> mm_per_unit;
  bool is_ras = false;
};

absl::Status add_row(const Row& row, const Columns& columns, char separator, size_t line, LandmarkList& list) {
  const auto cell = [&row](int column) {
    return column >= 0 && static_cast<size_t>(column) < row.size() ? row[static_cast<size_t>(column)] : std::string();
  };
  const std::string name = cell(columns.name);
  const std::string placed = absl::AsciiStrToLower(cell(columns.placed));
  if (name.empty() || placed == "0" || placed == "false") {
    ++list.passed_over;
    return absl::OkStatus();
  }
  Point at{};
  for (size_t c = 0; c < 3; ++c) {
    const std::string text = cell(columns.xyz[c]);
    const auto value = to_number(text, separator);
    if (!value) {
      return wrong_at(line,
                      absl::StrCat("coordinate ", c + 1, " of '", name, "' is '", text, "', not a finite number"));
    }
    at[c] = columns.is_ras && c < 2 ? 0.0 - *value : *value;
  }
  list.points.emplace_back(name, at);
  return absl::OkStatus();
}

/// Reads "# key = value" of a .fcsv.
absl::Status read_comment(const std::string& line, size_t number, Columns& columns) {
  const std::vector<std::string> parts = absl::StrSplit(line.substr(1), absl::MaxSplits('=', 1));
  if (parts.size() < 2) return absl::OkStatus();
  const std::string key = absl::AsciiStrToLower(std::string(absl::StripAsciiWhitespace(parts[0])));
  const std::string value(absl::StripAsciiWhitespace(parts[1]));
  if (key == "coordinatesystem") {
    columns.is_ras = value == "RAS" || value == "0";
    if (columns.is_ras || value == "LPS" || value == "1") return absl::OkStatus();
    return wrong_at(number, absl::StrCat("CoordinateSystem is '", value, "', must be LPS, RAS, 0 (RAS) or 1 (LPS)"));
  }
  if (key != "columns") return absl::OkStatus();
  const Row names = split_cells(value, ',');
  const auto column_of = [&names](const char* name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  };
  columns.name = column_of("label");
  columns.xyz = {column_of("x"), column_of("y"), column_of("z")};
  if (columns.name < 0 || *std::min_element(columns.xyz.begin(), columns.xyz.end()) < 0) {
    return wrong_at(number, "the columns have no label, x, y and z");
  }
  return absl::OkStatus();
}

char find_separator(const std::string& line) {
  for (const char separator : {'\t', ';'}) {
    if (line.find(separator) != std::string::npos) return separator;
  }
  return ',';
}

/// A column's name without its unit: "x_mm", "X (mm)", "x [cm]".
std::string take_unit(std::string name, std::optional<double>& mm_per_unit) {
  absl::AsciiStrToLower(&name);
  const size_t end = name.find_first_of("_ ([");
  if (end == std::string::npos) return name;
  for (const auto& [unit, mm] : {std::pair("mm", 1.0), std::pair("cm", 10.0), std::pair("m", 1000.0)}) {
    const std::string rest =
        absl::StrReplaceAll(name.substr(end), {{"_", ""}, {"(", ""}, {")", ""}, {"[", ""}, {"]", ""}, {" ", ""}});
    if (rest != unit) continue;
    mm_per_unit = mm;
    return name.substr(0, end);
  }
  return name;
}

/// The columns as a line of names gives them; nothing for a line that is none.
std::optional<Columns> read_heading(const Row& row) {
  Columns columns;
  for (size_t k = 0; k < row.size(); ++k) {
    const int column = static_cast<int>(k);
    const std::string name = take_unit(row[k], columns.mm_per_unit);
    if (name == "x" || name == "r" || name == "l") columns.xyz[0] = column;
    if (name == "y" || name == "a" || name == "p") columns.xyz[1] = column;
    if (name == "z" || name == "s") columns.xyz[2] = column;
    if (name == "r") columns.is_ras = true;
    if (name == "defined") columns.placed = column;
    if (name == "name" || name == "label" || name == "landmark" || name == "point") columns.name = column;
  }
  if (*std::min_element(columns.xyz.begin(), columns.xyz.end()) < 0) return std::nullopt;
  if (columns.name < 0 && row.size() > 3) columns.name = columns.xyz[0] == 0 ? 3 : 0;
  return columns;
}

/// Without a line of names: the name is what is no number, the coordinates are behind it, or before
/// it where it stands behind them.
std::optional<Columns> guess_columns(const Row& row, char separator) {
  const auto name =
      std::find_if(row.begin(), row.end(), [&](const std::string& cell) { return !to_number(cell, separator); });
  if (row.size() < 4 || name == row.end()) return std::nullopt;
  Columns columns;
  columns.name = static_cast<int>(name - row.begin());
  const int first = columns.name >= 3 ? columns.name - 3 : columns.name + 1;
  columns.xyz = {first, first + 1, first + 2};
  return columns;
}

}  // namespace

absl::StatusOr<LandmarkList> parse_fcsv(std::string_view text) {
  // As of version 4: id, x, y, z, ow, ox, oy, oz, vis, sel, lock, label, desc, associatedNodeID.
  Columns columns{11, {1, 2, 3}, -1, std::nullopt, true};
  LandmarkList list;
  const std::vector<std::string> lines = split_lines(text);
  for (size_t k = 0; k < lines.size(); ++k) {
    absl::Status status;
    if (absl::StartsWith(lines[k], "#")) {
      status = read_comment(lines[k], k + 1, columns);
    } else if (!absl::StripAsciiWhitespace(lines[k]).empty()) {
      status = add_row(split_cells(lines[k], ','), columns, ',', k + 1, list);
    }
    if (!status.ok()) return status;
  }
  list.was_ras = columns.is_ras;
  return list;
}

absl::StatusOr<LandmarkList> parse_landmark_table(std::string_view text) {
  LandmarkList list;
  std::optional<Columns> columns;
  char separator = ',';
  const std::vector<std::string> lines = split_lines(text);
  for (size_t k = 0; k < lines.size(); ++k) {
    if (absl::StripAsciiWhitespace(lines[k]).empty() || lines[k].front() == '#') continue;
    if (!columns) separator = find_separator(lines[k]);
    const Row row = split_cells(lines[k], separator);
    if (!columns) {
      columns = read_heading(row);
      if (columns && columns->name < 0) return wrong_at(k + 1, "no column has the names of the points");
      if (columns) continue;
      columns = guess_columns(row, separator);
      if (!columns) return wrong_at(k + 1, absl::StrCat(row.size(), " columns, must be a name and three coordinates"));
    }
    if (const absl::Status status = add_row(row, *columns, separator, k + 1, list); !status.ok()) return status;
  }
  if (columns) {
    list.mm_per_unit = columns->mm_per_unit;
    list.was_ras = columns->is_ras;
  }
  return list;
}

}  // namespace lipofill::client
