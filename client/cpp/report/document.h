#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "client/cpp/report/language.h"

namespace lipofill::client {

/// A figure that is shown, and where it comes from.
struct Figure {
  std::string field;   ///< JSON pointer into the record of the report: "/planned/summary/injected_ml"
  double value = 0.0;  ///< as it is there
  double scale = 1.0;  ///< from there to the unit that is shown
  std::string unit;    ///< that is shown
};

/// Words of a cell, or one figure of it.
struct Piece {
  std::string text;
  std::optional<Figure> figure{};
};

/// A cell of a table.
struct Cell {
  std::vector<Piece> pieces;
  std::string language{};  ///< a code where it is another than that of the document
  std::string mark{};      ///< a colour beside the words, as CSS; never alone
};

/// A table whose first row and first column say what the others are.
struct Table {
  std::string id;
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;
};

/// A picture, and in words what it shows.
struct ReportPicture {
  std::string png;  ///< the bytes of the file
  std::string alternative;
};

/// Pictures in rows and columns that have headings.
struct PictureTable {
  std::string id;
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::pair<std::string, std::vector<ReportPicture>>> rows;
};

/// A bar of colours between two values, with what they mean.
struct ColourScale {
  std::string caption;
  std::string unit;
  double low = 0.0;
  double high = 0.0;
  int decimals = 1;
  std::vector<std::string> colours{};  ///< CSS, evenly spaced from low to high
};

/// Pictures beside one another, each with its caption and its scale.
struct Map {
  ReportPicture picture;
  std::string caption;
  std::optional<ColourScale> scale{};
  std::vector<std::pair<std::string, std::string>> legend{};  ///< colours and what they mean
};
struct Maps {
  std::vector<Map> maps;
};

struct Paragraph {
  std::vector<Piece> pieces;
  std::string language{};
};
struct BulletList {
  std::vector<std::string> items;
  std::string language{};
};
struct CodeLine {
  std::string text;
};

using Block = std::variant<Paragraph, BulletList, CodeLine, Table, PictureTable, Maps>;

struct Section {
  std::string id;
  std::string heading;
  std::vector<Block> blocks{};
  bool begins_page = false;
};

enum class Paper { kA4, kLetter };

/// All that a report shows, in its order, without how it looks.
struct ReportDocument {
  Language language = Language::kEnglish;
  Paper paper = Paper::kA4;
  std::string title;
  std::string notice;  ///< at the head and the foot of every page
  std::string running_head;
  std::string page_of;  ///< "page $0 of $1"
  std::vector<Section> sections{};
};

}  // namespace lipofill::client
