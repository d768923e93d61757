#include <vtkDataArray.h>
#include <vtkType.h>

#include <cmath>
#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {
namespace {

/// VTK's name for the type, or 0.
int vtk_type_of(const std::string& type) {
  static const std::map<std::string, int> types = {{"signed char", VTK_SIGNED_CHAR},
                                                   {"int8", VTK_SIGNED_CHAR},
                                                   {"int8_t", VTK_SIGNED_CHAR},
                                                   {"uchar", VTK_UNSIGNED_CHAR},
                                                   {"unsigned char", VTK_UNSIGNED_CHAR},
                                                   {"uint8", VTK_UNSIGNED_CHAR},
                                                   {"uint8_t", VTK_UNSIGNED_CHAR},
                                                   {"short", VTK_SHORT},
                                                   {"short int", VTK_SHORT},
                                                   {"signed short", VTK_SHORT},
                                                   {"int16", VTK_SHORT},
                                                   {"int16_t", VTK_SHORT},
                                                   {"ushort", VTK_UNSIGNED_SHORT},
                                                   {"unsigned short", VTK_UNSIGNED_SHORT},
                                                   {"uint16", VTK_UNSIGNED_SHORT},
                                                   {"uint16_t", VTK_UNSIGNED_SHORT},
                                                   {"int", VTK_INT},
                                                   {"signed int", VTK_INT},
                                                   {"int32", VTK_INT},
                                                   {"int32_t", VTK_INT},
                                                   {"uint", VTK_UNSIGNED_INT},
                                                   {"unsigned int", VTK_UNSIGNED_INT},
                                                   {"uint32", VTK_UNSIGNED_INT},
                                                   {"uint32_t", VTK_UNSIGNED_INT},
                                                   {"float", VTK_FLOAT},
                                                   {"double", VTK_DOUBLE}};
  const auto found = types.find(type);
  return found == types.end() ? 0 : found->second;
}

/// The signs that turn the file's space into LPS; none for a space that names no patient axes.
std::optional<std::array<double, 3>> signs_to_lps(const std::string& space) {
  if (space == "left-posterior-superior" || space == "lps") return std::array<double, 3>{1, 1, 1};
  if (space == "right-anterior-superior" || space == "ras") return std::array<double, 3>{-1, -1, 1};
  if (space == "left-anterior-superior" || space == "las") return std::array<double, 3>{1, -1, 1};
  return std::nullopt;
}

absl::Status set_directions(const std::filesystem::path& file, const HeaderText& text, Affine* affine) {
  const bool directed = text.has("space directions");
  const std::string value = directed ? text.value("space directions") : text.value("spacings");
  const auto numbers = parse_numbers(value.empty() ? "1 1 1" : value);
  const size_t expected = directed ? 9 : 3;
  if (!numbers || numbers->size() != expected) {
    return bad_volume(file, absl::StrCat("has ", directed ? "space directions" : "spacings", " \"", value,
                                         "\", which are not ", expected, " numbers"));
  }
  for (size_t row = 0; row < 3; ++row) {
    for (size_t axis = 0; axis < 3; ++axis) {
      (*affine)[4 * row + axis] = directed ? (*numbers)[3 * axis + row] : (row == axis ? (*numbers)[axis] : 0.0);
    }
  }
  return absl::OkStatus();
}

/// p = origin + sum_a index_a direction_a, turned to LPS.
absl::Status set_geometry(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  Affine affine{};
  affine[15] = 1.0;
  if (auto status = set_directions(file, text, &affine); !status.ok()) return status;
  const std::string origin_text = text.value("space origin");
  const auto origin = parse_numbers(origin_text.empty() ? "0 0 0" : origin_text);
  if (!origin || origin->size() != 3)
    return bad_volume(file, absl::StrCat("has space origin \"", origin_text, "\", which is not three numbers"));
  for (size_t row = 0; row < 3; ++row) affine[4 * row + 3] = (*origin)[row];
  const auto signs = signs_to_lps(absl::AsciiStrToLower(text.value("space")));
  for (size_t row = 0; signs && row < 3; ++row) {
    for (size_t column = 0; column < 4; ++column) affine[4 * row + column] *= (*signs)[row];
  }
  header->index_to_mm = affine;
  header->frame = signs ? "LPS" : "the file's own";
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<VolumeHeader> parse_nrrd_header(const std::filesystem::path& file) {
  const auto text = read_header_text(file, ':', "");
  if (!text.ok()) return text.status();
  if (!text->first_line.starts_with("NRRD000"))
    return bad_volume(file, "is not a NRRD: it does not begin with NRRD000");
  if (text->value("dimension") != "3")
    return bad_volume(file, absl::StrCat("has dimension ", text->value("dimension"), ", not 3"));
  const auto sizes = parse_sizes(file, "sizes", text->value("sizes"));
  if (!sizes.ok()) return sizes.status();
  VolumeHeader header;
  header.format = VolumeFormat::kNrrd;
  header.size = *sizes;
  header.vtk_type = vtk_type_of(text->value("type"));
  if (header.vtk_type == 0)
    return bad_volume(file, absl::StrCat("has type \"", text->value("type"), "\", which is not supported"));
  header.bytes_per_voxel = static_cast<uint64_t>(vtkDataArray::GetDataTypeSize(header.vtk_type));
  const std::string endian = text->has("endian") ? text->value("endian") : "little";
  if (endian != "little" && endian != "big")
    return bad_volume(file, absl::StrCat("has endian \"", endian, "\", not little or big"));
  header.big_endian = endian == "big";
  const std::string encoding = text->value("encoding");
  if (encoding != "raw" && encoding != "gzip" && encoding != "gz")
    return bad_volume(file, absl::StrCat("has encoding \"", encoding, "\", not raw or gzip"));
  header.compressed = encoding != "raw";
  for (const char* key : {"line skip", "lineskip", "byte skip", "byteskip"}) {
    if (text->has(key) && text->value(key) != "0")
      return bad_volume(file, absl::StrCat("has a ", key, ", which is not supported"));
  }
  const std::string data = text->has("data file") ? text->value("data file") : text->value("datafile");
  if (data.starts_with("LIST") || data.find('%') != std::string::npos)
    return bad_volume(file, "has its slices in files of their own; join them first");
  header.data_file = data.empty() ? file : file.parent_path() / data;
  header.data_offset = data.empty() ? text->end : 0;
  if (auto status = set_geometry(file, *text, &header); !status.ok()) return status;
  return header;
}

}  // namespace lipofill::client
