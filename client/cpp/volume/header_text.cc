#include "client/cpp/volume/header_text.h"

#include <cmath>
#include <fstream>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"

namespace lipofill::client {
namespace {

constexpr uint64_t kMaxHeaderBytes = 1 << 20;
constexpr uint64_t kMaxVoxelsAlong = 65535;
constexpr char kByteOrderMark[] = "\xEF\xBB\xBF";

bool is_list(absl::string_view value) {
  return absl::AsciiStrToUpper(value.substr(0, 4)) == "LIST";
}

/// The fields of teem's NRRD, in every spelling (nrrd/enumsNrrd.c); others are refused, as a field
/// with a slip of the pen would move the head without a word.
bool is_nrrd_field(const std::string& key) {
  static const std::set<std::string> fields = {"content",
                                               "number",
                                               "type",
                                               "block size",
                                               "blocksize",
                                               "dimension",
                                               "space",
                                               "sizes",
                                               "spacings",
                                               "space dimension",
                                               "spacedimension",
                                               "thicknesses",
                                               "axis mins",
                                               "axismins",
                                               "axis maxs",
                                               "axismaxs",
                                               "space directions",
                                               "spacedirections",
                                               "centers",
                                               "centerings",
                                               "kinds",
                                               "labels",
                                               "units",
                                               "min",
                                               "max",
                                               "old min",
                                               "oldmin",
                                               "old max",
                                               "oldmax",
                                               "endian",
                                               "encoding",
                                               "line skip",
                                               "lineskip",
                                               "byte skip",
                                               "byteskip",
                                               "sample units",
                                               "sampleunits",
                                               "space units",
                                               "spaceunits",
                                               "space origin",
                                               "spaceorigin",
                                               "data file",
                                               "datafile",
                                               "measurement frame",
                                               "measurementframe"};
  return fields.count(key) > 0;
}

/// The beginning of a line, for a message.
std::string as_shown(absl::string_view line) {
  std::string shown(line.substr(0, 60));
  for (char& c : shown) {
    if (!absl::ascii_isprint(static_cast<unsigned char>(c))) c = '?';
  }
  return shown;
}

enum class Line { kField, kFiles, kNote, kWrong };

/// Puts a line's field into the text, and says what the line was.
Line take_line(absl::string_view line, HeaderDialect dialect, HeaderText* text) {
  const bool is_nrrd = dialect == HeaderDialect::kNrrd;
  if (line.front() == '#') return Line::kNote;
  const size_t middle = line.find_first_of(is_nrrd ? ":" : "=:");
  if (middle == absl::string_view::npos) return is_nrrd ? Line::kWrong : Line::kNote;
  if (is_nrrd && line.substr(middle, 2) == ":=") {
    text->notes[std::string(line.substr(0, middle))] = std::string(absl::StripAsciiWhitespace(line.substr(middle + 2)));
    return Line::kNote;
  }
  const std::string key = absl::AsciiStrToLower(absl::StripAsciiWhitespace(line.substr(0, middle)));
  if (is_nrrd && !is_nrrd_field(key)) return Line::kWrong;
  text->values[key] = std::string(absl::StripAsciiWhitespace(line.substr(middle + 1)));
  return key == "elementdatafile" || key == "data file" || key == "datafile" ? Line::kFiles : Line::kField;
}

/// Reads the line that begins at `*begin` and moves it behind its end.
absl::string_view next_line(absl::string_view head, size_t* begin) {
  const size_t end = std::min(head.find('\n', *begin), head.size());
  const absl::string_view line = head.substr(*begin, end - *begin);
  *begin = std::min(end + 1, head.size());
  return line;
}

/// One number of a pattern in place of its %d, %03d and so on; none for another pattern.
std::optional<std::string> fill_pattern(absl::string_view pattern, int64_t number) {
  const size_t begin = pattern.find('%');
  const size_t end = pattern.find_first_not_of("0123456789", begin + 1);
  if (end == absl::string_view::npos || pattern[end] != 'd' || end - begin > 4) return std::nullopt;
  if (pattern.find('%', end) != absl::string_view::npos) return std::nullopt;
  const absl::string_view digits = pattern.substr(begin + 1, end - begin - 1);
  int width = 0;
  if (!digits.empty() && !absl::SimpleAtoi(digits, &width)) return std::nullopt;
  std::string text = absl::StrCat(number);
  const char fill = absl::StartsWith(digits, "0") ? '0' : ' ';
  if (text.size() < static_cast<size_t>(width)) text.insert(0, static_cast<size_t>(width) - text.size(), fill);
  return absl::StrCat(pattern.substr(0, begin), text, pattern.substr(end + 1));
}

/// "slice.%03d.raw 1 62 1", with what a NRRD may add about the axes of a slice.
absl::StatusOr<std::vector<std::string>> numbered_files(const std::filesystem::path& file, const std::string& name) {
  const std::vector<std::string> words = absl::StrSplit(name, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  int64_t first = 0, last = 0, step = 1;
  if (words.size() < 3 || !absl::SimpleAtoi(words[1], &first) || !absl::SimpleAtoi(words[2], &last) ||
      (words.size() > 3 && !absl::SimpleAtoi(words[3], &step)) || step == 0 || std::abs(first) > 1'000'000'000 ||
      std::abs(last) > 1'000'000'000 || std::abs(step) > 1'000'000'000 || (last - first) / step < 0) {
    return bad_volume(file,
                      absl::StrCat("names its slices by \"", name, "\", which is not \"pattern first last step\""));
  }
  const int64_t count = (last - first) / step + 1;
  if (count > static_cast<int64_t>(kMaxVoxelsAlong))
    return bad_volume(file, absl::StrCat("names ", count, " files, must be at most ", kMaxVoxelsAlong));
  std::vector<std::string> names;
  for (int64_t k = 0; k < count; ++k) {
    const auto filled = fill_pattern(words[0], first + k * step);
    if (!filled)
      return bad_volume(file, absl::StrCat("names its slices by \"", words[0], "\", which must have one %d or %03d"));
    names.push_back(*filled);
  }
  return names;
}

}  // namespace

std::string HeaderText::value(const std::string& key) const {
  const auto found = values.find(key);
  return found == values.end() ? std::string() : found->second;
}

std::string HeaderText::first_of(std::initializer_list<const char*> keys) const {
  for (const char* key : keys) {
    if (has(key)) return value(key);
  }
  return {};
}

absl::StatusOr<HeaderText> read_header_text(const std::filesystem::path& file, HeaderDialect dialect) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return bad_volume(file, "cannot be read");
  std::string bytes(kMaxHeaderBytes, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(stream.gcount()));
  const absl::string_view head = bytes;
  HeaderText text;
  bool in_list = false;
  for (size_t begin = absl::StartsWith(head, kByteOrderMark) ? 3 : 0; begin < head.size();) {
    const bool is_first = text.end == 0;
    const absl::string_view line = next_line(head, &begin);
    if (line.find('\0') != absl::string_view::npos)
      return bad_volume(file, "has a byte of 0 in its header, which is text");
    const absl::string_view stripped = absl::StripAsciiWhitespace(line);
    if (is_first) text.first_line = std::string(stripped);
    text.end = begin;
    if (in_list) {
      if (!stripped.empty()) text.files.emplace_back(stripped);
    } else if (stripped.empty()) {
      if (dialect == HeaderDialect::kNrrd) return text;
    } else if (dialect == HeaderDialect::kMetaImage || !is_first) {
      const Line what = take_line(stripped, dialect, &text);
      if (what == Line::kWrong)
        return bad_volume(file, absl::StrCat("has the line \"", as_shown(stripped), "\", which is no field of a NRRD"));
      if (what != Line::kFiles) continue;
      in_list = is_list(text.first_of({"elementdatafile", "data file", "datafile"}));
      if (dialect == HeaderDialect::kMetaImage && !in_list) return text;
    }
  }
  if (head.size() == kMaxHeaderBytes)
    return bad_volume(file, absl::StrCat("has no end of its header in the first ", kMaxHeaderBytes, " bytes"));
  return text;
}

std::optional<std::vector<double>> parse_numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const auto& word : absl::StrSplit(text, absl::ByAnyChar(" \t,()"), absl::SkipEmpty())) {
    double number = 0.0;
    if (!absl::SimpleAtod(word, &number) || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

absl::StatusOr<std::vector<uint64_t>> parse_sizes(const std::filesystem::path& file, const std::string& key,
                                                  const std::string& text) {
  const auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() < 3)
    return bad_volume(file, absl::StrCat("has ", key, " \"", text, "\", which is not three sizes"));
  std::vector<uint64_t> sizes;
  for (const double size : *numbers) {
    if (size < 1 || size > static_cast<double>(kMaxVoxelsAlong) || size != std::floor(size))
      return bad_volume(file, absl::StrCat("has ", key, " ", size, ", not in [1, ", kMaxVoxelsAlong, "]"));
    sizes.push_back(static_cast<uint64_t>(size));
  }
  return sizes;
}

absl::StatusOr<std::array<uint64_t, 3>> three_sizes(const std::filesystem::path& file, const std::string& key,
                                                    const std::vector<uint64_t>& sizes) {
  const std::string all = absl::StrJoin(sizes, " x ");
  for (size_t k = 0; k < sizes.size(); ++k) {
    if (k < 3 && sizes[k] < 2)
      return bad_volume(file, absl::StrCat("has ", key, " ", all, ": axis ", k + 1, " has ", sizes[k],
                                           " voxel, a volume has at least 2 along each of its three axes"));
    if (k >= 3 && sizes[k] > 1)
      return bad_volume(file, absl::StrCat("has ", key, " ", all, ", more than one volume: save the one that shows ",
                                           "the head in a file of its own"));
  }
  return std::array<uint64_t, 3>{sizes[0], sizes[1], sizes[2]};
}

absl::StatusOr<int64_t> parse_count(const std::filesystem::path& file, const std::string& key, const std::string& text,
                                    int64_t least, int64_t most, int64_t otherwise) {
  int64_t count = 0;
  if (text.empty()) return otherwise;
  if (!absl::SimpleAtoi(text, &count) || count < least || count > most) {
    return bad_volume(file,
                      absl::StrCat("has ", key, " \"", text, "\", not a whole number in [", least, ", ", most, "]"));
  }
  return count;
}

absl::StatusOr<std::vector<std::filesystem::path>> data_files(const std::filesystem::path& file,
                                                              const std::string& name,
                                                              const std::vector<std::string>& list) {
  std::vector<std::string> names = {name};
  if (is_list(name)) {
    names = list;
    if (names.empty() || names.size() > kMaxVoxelsAlong)
      return bad_volume(file, absl::StrCat("names ", names.size(), " files, not in [1, ", kMaxVoxelsAlong, "]"));
  } else if (absl::StrContains(name, '%')) {
    auto numbered = numbered_files(file, name);
    if (!numbered.ok()) return numbered.status();
    names = *std::move(numbered);
  }
  std::vector<std::filesystem::path> files;
  for (const std::string& each : names) files.push_back(file.parent_path() / each);
  return files;
}

absl::Status bad_volume(const std::filesystem::path& file, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("volume ", file.string(), " ", what));
}

}  // namespace lipofill::client
