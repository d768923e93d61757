#include <vtkDataArray.h>
#include <vtkType.h>

#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {
namespace {

/// MetaIO takes "True", "true", "T" and "1" for true.
bool is_true(const std::string& value) {
  return !value.empty() && (absl::ascii_tolower(static_cast<unsigned char>(value[0])) == 't' || value[0] == '1');
}

/// The numbers of a key, or those of the identity; as many as `expected`.
absl::StatusOr<std::vector<double>> numbers_of(const std::filesystem::path& file, const char* key,
                                               const std::string& text, size_t expected,
                                               std::vector<double> otherwise) {
  if (text.empty()) return otherwise;
  const auto numbers = parse_numbers(text);
  if (numbers && numbers->size() == expected) return *numbers;
  return bad_volume(file, absl::StrCat("has ", key, " \"", text, "\", which is not ", expected, " numbers"));
}

std::vector<double> identity(size_t n) {
  std::vector<double> matrix(n * n, 0.0);
  for (size_t k = 0; k < n; ++k) matrix[k * n + k] = 1.0;
  return matrix;
}

/// p = offset + sum_a index_a spacing_a (row a of TransformMatrix); MetaImage's axes are LPS. Of
/// `n` axes the first three are those of space.
absl::Status set_geometry(const std::filesystem::path& file, const HeaderText& text, size_t n, VolumeHeader* header) {
  const auto spacing = numbers_of(file, "ElementSpacing", text.first_of({"elementspacing", "elementsize"}), n,
                                  std::vector<double>(n, 1.0));
  if (!spacing.ok()) return spacing.status();
  const auto offset =
      numbers_of(file, "Offset", text.first_of({"offset", "position", "origin"}), n, std::vector<double>(n, 0.0));
  if (!offset.ok()) return offset.status();
  const auto matrix = numbers_of(file, "TransformMatrix", text.first_of({"transformmatrix", "rotation", "orientation"}),
                                 n * n, identity(n));
  if (!matrix.ok()) return matrix.status();
  header->index_to_mm = {};
  header->index_to_mm[15] = 1.0;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t axis = 0; axis < 3; ++axis)
      header->index_to_mm[4 * row + axis] = (*matrix)[n * axis + row] * (*spacing)[axis];
    header->index_to_mm[4 * row + 3] = (*offset)[row];
  }
  header->frame = "LPS";
  return absl::OkStatus();
}

/// VTK's name for the type, or 0. A long has 4 bytes for MetaIO, on every machine.
int vtk_type_of(const std::string& type) {
  static const std::map<std::string, int> types = {{"MET_CHAR", VTK_SIGNED_CHAR},
                                                   {"MET_ASCII_CHAR", VTK_SIGNED_CHAR},
                                                   {"MET_UCHAR", VTK_UNSIGNED_CHAR},
                                                   {"MET_SHORT", VTK_SHORT},
                                                   {"MET_USHORT", VTK_UNSIGNED_SHORT},
                                                   {"MET_INT", VTK_INT},
                                                   {"MET_UINT", VTK_UNSIGNED_INT},
                                                   {"MET_LONG", VTK_INT},
                                                   {"MET_ULONG", VTK_UNSIGNED_INT},
                                                   {"MET_LONG_LONG", VTK_LONG_LONG},
                                                   {"MET_ULONG_LONG", VTK_UNSIGNED_LONG_LONG},
                                                   {"MET_FLOAT", VTK_FLOAT},
                                                   {"MET_DOUBLE", VTK_DOUBLE}};
  const auto found = types.find(absl::AsciiStrToUpper(type));
  return found == types.end() ? 0 : found->second;
}

/// Sets the layout of the voxels, which must be one scalar each.
absl::Status set_voxels(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  header->vtk_type = vtk_type_of(text.value("elementtype"));
  if (header->vtk_type == 0) {
    return bad_volume(file,
                      absl::StrCat("has ElementType \"", text.value("elementtype"), "\", which is not a scalar type"));
  }
  header->bytes_per_voxel = static_cast<uint64_t>(vtkDataArray::GetDataTypeSize(header->vtk_type));
  const std::string channels = text.value("elementnumberofchannels");
  if (!channels.empty() && channels != "1") return bad_volume(file, absl::StrCat("has ", channels, " channels, not 1"));
  header->big_endian = is_true(text.first_of({"binarydatabyteordermsb", "elementbyteordermsb"}));
  if (text.has("binarydata") && !is_true(text.value("binarydata"))) {
    header->voxels.encoding = VoxelEncoding::kText;
    header->big_endian = false;
  } else if (is_true(text.value("compresseddata"))) {
    header->voxels.encoding = VoxelEncoding::kZlib;
  }
  return absl::OkStatus();
}

/// Sets where the voxels lie. HeaderSize counts from the beginning of a file, -1 from its end.
absl::Status set_files(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  const std::string data = text.value("elementdatafile");
  const auto header_size = parse_count(file, "HeaderSize", text.value("headersize"), -1, int64_t{1} << 40, 0);
  if (!header_size.ok()) return header_size.status();
  const bool local = absl::AsciiStrToLower(data) == "local";
  if (local) header->voxels.offset = text.end;
  if (*header_size > 0) header->voxels.offset = static_cast<uint64_t>(*header_size);
  if (*header_size < 0) header->voxels.skip = -1;
  if (local) {
    header->voxels.files = {file};
    return absl::OkStatus();
  }
  auto files = data_files(file, data, text.files);
  if (!files.ok()) return files.status();
  header->voxels.files = *std::move(files);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<VolumeHeader> parse_metaimage_header(const std::filesystem::path& file) {
  const auto text = read_header_text(file, HeaderDialect::kMetaImage);
  if (!text.ok()) return text.status();
  if (!text->has("elementdatafile") || !text->has("dimsize"))
    return bad_volume(file, "is not a MetaImage: it lacks DimSize or ElementDataFile");
  const auto dimensions = parse_sizes(file, "DimSize", text->value("dimsize"));
  if (!dimensions.ok()) return dimensions.status();
  const std::string count = text->value("ndims");
  if (!count.empty() && count != absl::StrCat(dimensions->size())) {
    return bad_volume(file, absl::StrCat("has NDims ", count, ", and a DimSize of ", dimensions->size(), " numbers: \"",
                                         text->value("dimsize"), "\""));
  }
  const auto sizes = three_sizes(file, "DimSize", *dimensions);
  if (!sizes.ok()) return sizes.status();
  VolumeHeader header;
  header.size = *sizes;
  if (auto status = set_voxels(file, *text, &header); !status.ok()) return status;
  if (auto status = set_files(file, *text, &header); !status.ok()) return status;
  if (auto status = set_geometry(file, *text, dimensions->size(), &header); !status.ok()) return status;
  return header;
}

}  // namespace lipofill::client
