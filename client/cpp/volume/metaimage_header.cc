#include <vtkDataArray.h>
#include <vtkType.h>

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

/// VTK's name for the type, or 0.
int vtk_type_of(const std::string& type) {
  static const std::map<std::string, int> types = {{"MET_CHAR", VTK_SIGNED_CHAR}, {"MET_UCHAR", VTK_UNSIGNED_CHAR},
                                                   {"MET_SHORT", VTK_SHORT},      {"MET_USHORT", VTK_UNSIGNED_SHORT},
                                                   {"MET_INT", VTK_INT},          {"MET_UINT", VTK_UNSIGNED_INT},
                                                   {"MET_FLOAT", VTK_FLOAT},      {"MET_DOUBLE", VTK_DOUBLE}};
  const auto found = types.find(type);
  return found == types.end() ? 0 : found->second;
}

/// Sets the layout of the voxels, which must be binary, one scalar each, on a grid of three axes.
absl::Status set_voxels(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  const std::string dimensions = text.value("ndims");
  if (!dimensions.empty() && dimensions != "3")
    return bad_volume(file, absl::StrCat("has NDims ", dimensions, ", not 3"));
  header->vtk_type = vtk_type_of(text.value("elementtype"));
  if (header->vtk_type == 0) {
    return bad_volume(file,
                      absl::StrCat("has ElementType \"", text.value("elementtype"), "\", which is not a scalar type"));
  }
  header->bytes_per_voxel = static_cast<uint64_t>(vtkDataArray::GetDataTypeSize(header->vtk_type));
  const std::string channels = text.value("elementnumberofchannels");
  if (!channels.empty() && channels != "1") return bad_volume(file, absl::StrCat("has ", channels, " channels, not 1"));
  if (text.has("binarydata") && !is_true(text.value("binarydata")))
    return bad_volume(file, "has its voxels as text, which is not supported");
  header->big_endian = is_true(value_of(text, {"binarydatabyteordermsb", "elementbyteordermsb"}));
  header->compressed = is_true(text.value("compresseddata"));
  return absl::OkStatus();
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
  if (auto status = set_voxels(file, *text, &header); !status.ok()) return status;
  const std::string data = text->value("elementdatafile");
  if (data.starts_with("LIST") || data.find('%') != std::string::npos)
    return bad_volume(file, "has its slices in files of their own; join them first");
  const bool local = absl::AsciiStrToLower(data) == "local";
  header.data_file = local ? file : file.parent_path() / data;
  header.data_offset = local ? text->end : 0;
  if (text->has("headersize") && text->value("headersize") != "0")
    return bad_volume(file, "has a HeaderSize, which is not supported");
  if (auto status = set_geometry(file, *text, &header); !status.ok()) return status;
  return header;
}

}  // namespace lipofill::client
