#include "client/cpp/volume/nrrd_geometry.h"

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace lipofill::client {
namespace {

/// An axis of the array, as far as the header says where it points.
struct Axis {
  uint64_t size = 0;
  std::optional<std::vector<double>> direction;
  std::string unit;
  double origin = 0.0;  ///< along the axis itself, where it has a spacing and no direction
};

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The signs that turn the file's space into LPS; none for a space that names no patient axes.
std::optional<std::array<double, 3>> signs_to_lps(std::string space) {
  if (space.ends_with("-time")) space.resize(space.size() - 5);
  if (space.size() == 4 && space.ends_with("t")) space.pop_back();
  if (space == "left-posterior-superior" || space == "lps") return std::array<double, 3>{1, 1, 1};
  if (space == "right-anterior-superior" || space == "ras") return std::array<double, 3>{-1, -1, 1};
  if (space == "left-anterior-superior" || space == "las") return std::array<double, 3>{1, -1, 1};
  return std::nullopt;
}

/// Spaces that name axes of a scanner or none at all.
bool is_other_space(const std::string& space) {
  static const std::set<std::string> spaces = {"",
                                               "scanner-xyz",
                                               "scanner-xyz-time",
                                               "3d-right-handed",
                                               "3d-left-handed",
                                               "3d-right-handed-time",
                                               "3d-left-handed-time"};
  return spaces.count(space) > 0;
}

/// Millimetres in a unit; none for a unit that is not known, which millimetres then stand for.
std::optional<double> millimetres_in(const std::string& unit) {
  static const std::map<std::string, double> units = {
      {"mm", 1.0},          {"millimeter", 1.0},   {"millimeters", 1.0},  {"millimetre", 1.0},   {"millimetres", 1.0},
      {"cm", 10.0},         {"centimeter", 10.0},  {"centimeters", 10.0}, {"centimetre", 10.0},  {"centimetres", 10.0},
      {"m", 1000.0},        {"meter", 1000.0},     {"meters", 1000.0},    {"metre", 1000.0},     {"metres", 1000.0},
      {"um", 1e-3},         {"\xC2\xB5m", 1e-3},   {"\xCE\xBCm", 1e-3},   {"micron", 1e-3},      {"microns", 1e-3},
      {"micrometer", 1e-3}, {"micrometers", 1e-3}, {"micrometre", 1e-3},  {"micrometres", 1e-3}, {"nm", 1e-6},
      {"in", 25.4},         {"inch", 25.4}};
  const auto found = units.find(absl::AsciiStrToLower(unit));
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

/// The words between quotation marks: "mm" "mm" "mm".
std::vector<std::string> quoted(const std::string& text) {
  std::vector<std::string> words;
  const std::vector<std::string> pieces = absl::StrSplit(text, '"');
  for (size_t k = 1; k < pieces.size(); k += 2) words.push_back(pieces[k]);
  return words;
}

/// One number an axis, kNone for "nan", "none" and "???".
std::optional<std::vector<double>> parse_per_axis(const std::string& text, size_t axes) {
  std::vector<double> values;
  for (const auto& word : absl::StrSplit(text, absl::ByAnyChar(" \t"), absl::SkipEmpty())) {
    double value = kNone;
    if (word != "none" && word != "???" && (!absl::SimpleAtod(word, &value) || std::isinf(value))) return std::nullopt;
    values.push_back(value);
  }
  if (values.size() != axes) return std::nullopt;
  return values;
}

/// "(1,0,0) none (0,1,0)": a vector or none an axis.
std::optional<std::vector<std::optional<std::vector<double>>>> parse_directions(const std::string& text) {
  std::vector<std::optional<std::vector<double>>> directions;
  for (size_t begin = text.find_first_not_of(" \t"); begin != std::string::npos;) {
    const bool is_vector = text[begin] == '(';
    const size_t end = is_vector ? text.find(')', begin) : std::min(text.find_first_of(" \t(", begin), text.size());
    if (end == std::string::npos) return std::nullopt;
    const std::string word = text.substr(begin, end - begin + (is_vector ? 1 : 0));
    const bool has_none = absl::StrContains(absl::AsciiStrToLower(word), "n");
    if (!is_vector && word != "none") return std::nullopt;
    directions.push_back(has_none ? std::nullopt : parse_numbers(word));
    if (!has_none && (!directions.back() || directions.back()->size() < 3)) return std::nullopt;
    begin = text.find_first_not_of(" \t", end + (is_vector ? 1 : 0));
  }
  return directions;
}

/// Axes by "spacings", else by "axis mins" and "axis maxs", whose samples are cells or, said so,
/// nodes.
absl::Status set_spacings(const std::filesystem::path& file, const HeaderText& text, std::vector<Axis>* axes) {
  const auto per_axis = [&](std::initializer_list<const char*> keys) {
    const std::string value = text.first_of(keys);
    return value.empty() ? std::optional(std::vector<double>(axes->size(), kNone))
                         : parse_per_axis(value, axes->size());
  };
  const auto spacings = per_axis({"spacings"});
  const auto mins = per_axis({"axis mins", "axismins"});
  const auto maxs = per_axis({"axis maxs", "axismaxs"});
  if (!spacings || !mins || !maxs) {
    return bad_volume(file, absl::StrCat("has spacings, axis mins or axis maxs that are not ", axes->size(),
                                         " numbers: \"", text.value("spacings"), "\""));
  }
  const std::vector<std::string> centers =
      absl::StrSplit(text.first_of({"centers", "centerings"}), absl::ByAnyChar(" \t"), absl::SkipEmpty());
  const std::vector<std::string> units = quoted(text.value("units"));
  for (size_t a = 0; a < axes->size(); ++a) {
    Axis& axis = (*axes)[a];
    const bool nodes = a < centers.size() && absl::AsciiStrToLower(centers[a]) == "node";
    const double steps = static_cast<double>(axis.size) - (nodes ? 1.0 : 0.0);
    const double extent = (*maxs)[a] - (*mins)[a];
    double spacing = (*spacings)[a];
    if (std::isnan(spacing) && !std::isnan(extent) && steps > 0.0) spacing = extent / steps;
    const bool is_placed = !std::isnan((*mins)[a]) && text.first_of({"space origin", "spaceorigin"}).empty();
    if (std::isnan(spacing)) spacing = 1.0;
    axis.direction = std::vector<double>{spacing};
    if (is_placed) axis.origin = (*mins)[a] + (nodes ? 0.0 : 0.5 * spacing);
    if (a < units.size()) axis.unit = units[a];
  }
  return absl::OkStatus();
}

absl::Status set_directions(const std::filesystem::path& file, const HeaderText& text, std::vector<Axis>* axes) {
  const std::string value = text.first_of({"space directions", "spacedirections"});
  const auto directions = parse_directions(absl::AsciiStrToLower(value));
  if (!directions || directions->size() != axes->size()) {
    return bad_volume(file,
                      absl::StrCat("has space directions \"", value, "\", which are not a vector of three numbers ",
                                   "for each of ", axes->size(), " axes"));
  }
  for (size_t a = 0; a < axes->size(); ++a) (*axes)[a].direction = (*directions)[a];
  return absl::OkStatus();
}

/// Leaves the three axes of space: first those of one sample without a direction go, then, from the
/// last, others of one sample.
absl::Status keep_three(const std::filesystem::path& file, const std::string& sizes, std::vector<Axis>* axes) {
  for (const bool keep_directed : {true, false}) {
    for (size_t a = axes->size(); a-- > 0 && axes->size() > 3;) {
      const Axis& axis = (*axes)[a];
      if (axis.size == 1 && !(keep_directed && axis.direction))
        axes->erase(axes->begin() + static_cast<std::ptrdiff_t>(a));
    }
  }
  if (axes->size() > 3) {
    return bad_volume(file, absl::StrCat("has sizes ", sizes, ", more than one volume or value a voxel: save the one ",
                                         "that shows the head in a file of its own"));
  }
  for (size_t a = 0; a < 3; ++a) {
    if (!(*axes)[a].direction)
      return bad_volume(file, absl::StrCat("has no direction for the axis of ", (*axes)[a].size, " samples"));
  }
  return absl::OkStatus();
}

/// The unit of an axis of space, or of a plain axis; a remark says where it is not known.
double scale_of(const std::string& unit, VolumeHeader* header) {
  if (unit.empty()) return 1.0;
  const auto scale = millimetres_in(unit);
  if (!scale) header->remarks.push_back(absl::StrCat("the unit \"", unit, "\" is not known: millimetres are assumed"));
  return scale.value_or(1.0);
}

absl::Status set_affine(const std::filesystem::path& file, const HeaderText& text, const std::vector<Axis>& axes,
                        VolumeHeader* header) {
  const std::string origin_text = text.first_of({"space origin", "spaceorigin"});
  const bool has_origin = !origin_text.empty() && !absl::StrContains(absl::AsciiStrToLower(origin_text), "n");
  const auto origin = parse_numbers(has_origin ? origin_text : "0 0 0");
  if (!origin || origin->size() < 3)
    return bad_volume(file, absl::StrCat("has space origin \"", origin_text, "\", which is not three numbers"));
  const std::string space = absl::AsciiStrToLower(text.value("space"));
  const auto signs = signs_to_lps(space);
  if (!signs && !is_other_space(space))
    return bad_volume(file, absl::StrCat("has space \"", text.value("space"), "\", which is none that NRRD knows"));
  const std::vector<std::string> space_units = quoted(text.first_of({"space units", "spaceunits"}));
  header->index_to_mm = {};
  header->index_to_mm[15] = 1.0;
  const bool directed = !text.first_of({"space directions", "spacedirections"}).empty();
  for (size_t row = 0; row < 3; ++row) {
    double scale = signs ? (*signs)[row] : 1.0;
    scale *= scale_of(directed && row < space_units.size() ? space_units[row] : axes[row].unit, header);
    for (size_t a = 0; a < 3; ++a) {
      const std::vector<double>& direction = *axes[a].direction;
      const double entry = directed ? direction[row] : (row == a ? direction[0] : 0.0);
      header->index_to_mm[4 * row + a] = scale * entry;
    }
    header->index_to_mm[4 * row + 3] = scale * ((*origin)[row] + axes[row].origin);
  }
  header->frame = signs ? "LPS" : "the file's own";
  return absl::OkStatus();
}

}  // namespace

absl::Status set_nrrd_geometry(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  const auto sizes = parse_sizes(file, "sizes", text.value("sizes"));
  if (!sizes.ok()) return sizes.status();
  if (text.value("dimension") != absl::StrCat(sizes->size())) {
    return bad_volume(file, absl::StrCat("has dimension \"", text.value("dimension"), "\", and ", sizes->size(),
                                         " sizes: \"", text.value("sizes"), "\""));
  }
  std::vector<Axis> axes;
  for (const uint64_t size : *sizes) {
    axes.emplace_back();
    axes.back().size = size;
  }
  const auto status = !text.first_of({"space directions", "spacedirections"}).empty()
                          ? set_directions(file, text, &axes)
                          : set_spacings(file, text, &axes);
  if (!status.ok()) return status;
  if (auto kept = keep_three(file, text.value("sizes"), &axes); !kept.ok()) return kept;
  const auto three = three_sizes(file, "sizes", {axes[0].size, axes[1].size, axes[2].size});
  if (!three.ok()) return three.status();
  header->size = *three;
  return set_affine(file, text, axes, header);
}

}  // namespace lipofill::client
