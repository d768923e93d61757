#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {
namespace {

bool is_true(const std::string& value) {
  return absl::AsciiStrToLower(value) == "true";
}

/// The first of several spellings of the same key.
std::string value_of(const HeaderText& text, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (text.has(key)) return text.value(key);
  }
  return {};
}

/// p = offset + sum_a index_a spacing_a (row a of TransformMatrix); MetaImage's axes are LPS.
absl::Status set_geometry(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  const std::string spacing_text = value_of(text, {"elementspacing", "elementsize"});
  const std::string offset_text = value_of(text, {"offset", "position", "origin"});
  const std::string matrix_text = value_of(text, {"transformmatrix", "rotation", "orientation"});
  const auto spacing = parse_numbers(spacing_text.empty() ? "1 1 1" : spacing_text);
  const auto offset = parse_numbers(offset_text.empty() ? "0 0 0" : offset_text);
  const auto matrix = parse_numbers(matrix_text.empty() ? "1 0 0 0 1 0 0 0 1" : matrix_text);
  if (!spacing || spacing->size() != 3)
    return bad_volume(file, absl::StrCat("has ElementSpacing \"", spacing_text, "\", which is not three numbers"));
  if (!offset || offset->size() != 3)
    return bad_volume(file, absl::StrCat("has Offset \"", offset_text, "\", which is not three numbers"));
  if (!matrix || matrix->size() != 9)
    return bad_volume(file, absl::StrCat("has TransformMatrix \"", matrix_text, "\", which is not nine numbers"));
  header->index_to_mm = {};
  header->index_to_mm[15] = 1.0;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t axis = 0; axis < 3; ++axis)
      header->index_to_mm[4 * row + axis] = (*matrix)[3 * axis + row] * (*spacing)[axis];
    header->index_to_mm[4 * row + 3] = (*offset)[row];
  }
  header->frame = "LPS";
  return absl::OkStatus();
}

uint64_t bytes_of_type(const std::string& type) {
  static const std::map<std::string, uint64_t> bytes = {{"MET_CHAR", 1},   {"MET_UCHAR", 1}, {"MET_SHORT", 2},
                                                        {"MET_USHORT", 2}, {"MET_INT", 4},   {"MET_UINT", 4},
                                                        {"MET_FLOAT", 4},  {"MET_DOUBLE", 8}};
  const auto found = bytes.find(type);
  return found == bytes.end() ? 0 : found->second;
}

}  // namespace

absl::StatusOr<VolumeHeader> parse_metaimage_header(const std::filesystem::path& file) {
  const auto text = read_header_text(file, '=', "elementdatafile");
  if (!text.ok()) return text.status();
  if (!text->has("elementdatafile") || !text->has("dimsize"))
    return bad_volume(file, "is not a MetaImage: it lacks DimSize or ElementDataFile");
  const auto sizes = parse_sizes(file, "DimSize", text->value("dimsize"));
  if (!sizes.ok()) return sizes.status();
  VolumeHeader header;
  header.format = VolumeFormat::kMetaImage;
  header.size = *sizes;
  header.bytes_per_voxel = bytes_of_type(text->value("elementtype"));
  if (header.bytes_per_voxel == 0)
    return bad_volume(file,
                      absl::StrCat("has ElementType \"", text->value("elementtype"), "\", which is not a scalar type"));
  const std::string channels = text->value("elementnumberofchannels");
  if (!channels.empty() && channels != "1") return bad_volume(file, absl::StrCat("has ", channels, " channels, not 1"));
  header.compressed = is_true(text->value("compresseddata"));
  const std::string data = text->value("elementdatafile");
  if (data.starts_with("LIST") || data.find('%') != std::string::npos)
    return bad_volume(file, "keeps its slices in files of their own; join them first");
  const bool local = absl::AsciiStrToLower(data) == "local";
  header.data_file = local ? file : file.parent_path() / data;
  header.data_offset = local ? text->end : 0;
  if (text->has("headersize") && text->value("headersize") != "0")
    return bad_volume(file, "has a HeaderSize, which is not supported");
  if (auto status = set_geometry(file, *text, &header); !status.ok()) return status;
  return header;
}

}  // namespace lipofill::client
