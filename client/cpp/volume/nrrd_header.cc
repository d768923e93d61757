#include <vtkDataArray.h>
#include <vtkType.h>

#include <map>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/nrrd_geometry.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {
namespace {

constexpr int64_t kMaxSkip = int64_t{1} << 40;

/// VTK's name for the type, or 0; in every spelling that teem reads.
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
                                                   {"signed short int", VTK_SHORT},
                                                   {"int16", VTK_SHORT},
                                                   {"int16_t", VTK_SHORT},
                                                   {"ushort", VTK_UNSIGNED_SHORT},
                                                   {"unsigned short", VTK_UNSIGNED_SHORT},
                                                   {"unsigned short int", VTK_UNSIGNED_SHORT},
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
                                                   {"longlong", VTK_LONG_LONG},
                                                   {"long long", VTK_LONG_LONG},
                                                   {"long long int", VTK_LONG_LONG},
                                                   {"signed long long", VTK_LONG_LONG},
                                                   {"signed long long int", VTK_LONG_LONG},
                                                   {"int64", VTK_LONG_LONG},
                                                   {"int64_t", VTK_LONG_LONG},
                                                   {"ulonglong", VTK_UNSIGNED_LONG_LONG},
                                                   {"unsigned long long", VTK_UNSIGNED_LONG_LONG},
                                                   {"unsigned long long int", VTK_UNSIGNED_LONG_LONG},
                                                   {"uint64", VTK_UNSIGNED_LONG_LONG},
                                                   {"uint64_t", VTK_UNSIGNED_LONG_LONG},
                                                   {"float", VTK_FLOAT},
                                                   {"double", VTK_DOUBLE}};
  // Any number of blanks may part the words of a type.
  const std::vector<std::string> words =
      absl::StrSplit(absl::AsciiStrToLower(type), absl::ByAnyChar(" \t"), absl::SkipEmpty());
  const auto found = types.find(absl::StrJoin(words, " "));
  return found == types.end() ? 0 : found->second;
}

std::optional<VoxelEncoding> encoding_of(const std::string& name) {
  static const std::map<std::string, VoxelEncoding> encodings = {
      {"raw", VoxelEncoding::kRaw},     {"gzip", VoxelEncoding::kZlib}, {"gz", VoxelEncoding::kZlib},
      {"bzip2", VoxelEncoding::kBzip2}, {"bz2", VoxelEncoding::kBzip2}, {"hex", VoxelEncoding::kHex},
      {"ascii", VoxelEncoding::kText},  {"text", VoxelEncoding::kText}, {"txt", VoxelEncoding::kText}};
  const auto found = encodings.find(absl::AsciiStrToLower(name));
  return found == encodings.end() ? std::nullopt : std::optional(found->second);
}

absl::Status set_voxels(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  header->vtk_type = vtk_type_of(text.value("type"));
  if (header->vtk_type == 0)
    return bad_volume(file, absl::StrCat("has type \"", text.value("type"), "\", which is not a scalar type"));
  header->bytes_per_voxel = static_cast<uint64_t>(vtkDataArray::GetDataTypeSize(header->vtk_type));
  const auto encoding = encoding_of(text.value("encoding"));
  if (!encoding) {
    return bad_volume(file, absl::StrCat("has encoding \"", text.value("encoding"),
                                         "\", which is not raw, gzip, bzip2, hex or ascii"));
  }
  header->voxels.encoding = *encoding;
  const std::string endian = absl::AsciiStrToLower(text.has("endian") ? text.value("endian") : "little");
  if (endian != "little" && endian != "big")
    return bad_volume(file, absl::StrCat("has endian \"", endian, "\", not little or big"));
  header->big_endian = endian == "big" && *encoding != VoxelEncoding::kText;
  return absl::OkStatus();
}

/// Sets where the voxels lie: behind the header or in files of their own, and what to pass over.
absl::Status set_files(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header) {
  const auto lines = parse_count(file, "line skip", text.first_of({"line skip", "lineskip"}), 0, kMaxSkip, 0);
  if (!lines.ok()) return lines.status();
  const auto bytes = parse_count(file, "byte skip", text.first_of({"byte skip", "byteskip"}), -kMaxSkip, kMaxSkip, 0);
  if (!bytes.ok()) return bytes.status();
  header->voxels.line_skip = static_cast<uint64_t>(*lines);
  // The bytes to skip are unpacked ones, but of text they are its characters.
  const VoxelEncoding encoding = header->voxels.encoding;
  const bool is_text = encoding == VoxelEncoding::kText || encoding == VoxelEncoding::kHex;
  if (is_text && *bytes < 0)
    return bad_volume(file,
                      absl::StrCat("has a byte skip of ", *bytes, ", which text cannot have: must be at least 0"));
  if (is_text) {
    header->voxels.byte_skip = static_cast<uint64_t>(*bytes);
  } else {
    header->voxels.skip = *bytes;
  }
  const std::string data = text.first_of({"data file", "datafile"});
  if (data.empty()) {
    header->voxels.files = {file};
    header->voxels.offset = text.end;
    return absl::OkStatus();
  }
  auto files = data_files(file, data, text.files);
  if (!files.ok()) return files.status();
  header->voxels.files = *std::move(files);
  return absl::OkStatus();
}

/// The names that 3D Slicer gives to labels: "Segment0_LabelValue:=1" and "Segment0_Name:=bone".
LabelNames names_of_segments(const HeaderText& text) {
  constexpr absl::string_view kName = "_Name", kValue = "_LabelValue";
  LabelNames names;
  for (const auto& [key, name] : text.notes) {
    if (!absl::StartsWith(key, "Segment") || !absl::EndsWith(key, kName)) continue;
    const std::string segment = key.substr(0, key.size() - kName.size());
    const auto value = text.notes.find(absl::StrCat(segment, kValue));
    int64_t label = 0;
    if (value != text.notes.end() && absl::SimpleAtoi(value->second, &label)) names[label] = name;
  }
  return names;
}

}  // namespace

absl::StatusOr<VolumeHeader> parse_nrrd_header(const std::filesystem::path& file) {
  const auto text = read_header_text(file, HeaderDialect::kNrrd);
  if (!text.ok()) return text.status();
  if (!text->first_line.starts_with("NRRD00")) return bad_volume(file, "is not a NRRD: it does not begin with NRRD000");
  VolumeHeader header;
  if (auto status = set_voxels(file, *text, &header); !status.ok()) return status;
  if (auto status = set_files(file, *text, &header); !status.ok()) return status;
  if (auto status = set_nrrd_geometry(file, *text, &header); !status.ok()) return status;
  header.label_names = names_of_segments(*text);
  return header;
}

}  // namespace lipofill::client
