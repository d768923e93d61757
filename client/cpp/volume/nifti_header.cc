#include <vtkDataArray.h>
#include <vtkType.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/nifti_fields.h"
#include "client/cpp/volume/nifti_geometry.h"
#include "client/cpp/volume/unpacking.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {
namespace {

/// VTK's name for a datatype, or 0 for colours and complex numbers.
int vtk_type_of(int64_t datatype) {
  static const std::map<int64_t, int> types = {{2, VTK_UNSIGNED_CHAR},
                                               {4, VTK_SHORT},
                                               {8, VTK_INT},
                                               {16, VTK_FLOAT},
                                               {64, VTK_DOUBLE},
                                               {256, VTK_SIGNED_CHAR},
                                               {512, VTK_UNSIGNED_SHORT},
                                               {768, VTK_UNSIGNED_INT},
                                               {1024, VTK_LONG_LONG},
                                               {1280, VTK_UNSIGNED_LONG_LONG}};
  const auto found = types.find(datatype);
  return found == types.end() ? 0 : found->second;
}

/// Tells how a file is packed, by its first bytes.
VoxelEncoding packing_of(const std::filesystem::path& file) {
  std::array<char, 3> magic{};
  std::ifstream(file, std::ios::binary).read(magic.data(), magic.size());
  if (magic[0] == '\x1f' && magic[1] == '\x8b') return VoxelEncoding::kZlib;
  if (std::string_view(magic.data(), 3) == "BZh") return VoxelEncoding::kBzip2;
  return VoxelEncoding::kRaw;
}

absl::StatusOr<std::string> read_header_bytes(const std::filesystem::path& file) {
  std::string bytes;
  VoxelStream whole;
  whole.files = {file};
  whole.encoding = packing_of(file);
  const auto status = unpack_voxels(whole, kNifti2HeaderBytes, [&bytes](const unsigned char* piece, size_t size) {
    bytes.append(reinterpret_cast<const char*>(piece), size);
    return true;
  });
  if (!status.ok()) return bad_volume(file, status.message());
  return bytes;
}

absl::StatusOr<std::array<uint64_t, 3>> sizes_of(const std::filesystem::path& file, const NiftiFields& fields) {
  const int64_t dimensions = fields.dim[0];
  if (dimensions < 3 || dimensions > 7) return bad_volume(file, absl::StrCat("has ", dimensions, " dimensions, not 3"));
  std::string text;
  for (int64_t k = 1; k <= dimensions; ++k) {
    const int64_t size = fields.dim[static_cast<size_t>(k)];
    // Programs write 0 for an axis that is not there.
    absl::StrAppend(&text, k > 3 && size == 0 ? 1 : size, " ");
  }
  const auto sizes = parse_sizes(file, "dim", text);
  if (!sizes.ok()) return sizes.status();
  return three_sizes(file, "dim", *sizes);
}

/// face.hdr has its voxels in face.img, face.hdr.gz in face.img.gz, and either may be packed.
std::filesystem::path image_of(const std::filesystem::path& header) {
  std::string name = header.filename().string();
  const size_t at = absl::AsciiStrToLower(name).rfind(".hdr");
  const bool upper = at != std::string::npos && name[at + 1] == 'H';
  if (at != std::string::npos) name.replace(at, 4, upper ? ".IMG" : ".img");
  const std::filesystem::path image = header.parent_path() / name;
  std::error_code error;
  if (std::filesystem::exists(image, error) || at == std::string::npos) return image;
  const bool packed = name.size() > at + 4;
  return packed ? header.parent_path() / name.substr(0, at + 4) : header.parent_path() / (name + ".gz");
}

/// Sets where the voxels lie; an offset of 0 stands for the first byte they may have.
absl::Status set_files(const std::filesystem::path& file, const NiftiFields& fields, VolumeHeader* header) {
  const double least = fields.single_file ? static_cast<double>(fields.header_bytes) : 0.0;
  double offset = fields.voxel_offset;
  if (offset == 0.0 && fields.single_file) offset = least + 4.0;
  if (!(offset >= least && offset <= 1e9))
    return bad_volume(file, absl::StrCat("has vox_offset ", offset, ", not in [", least, ", 1e9]"));
  header->voxels.skip = static_cast<int64_t>(offset);
  header->voxels.files = {fields.single_file ? file : image_of(file)};
  header->voxels.encoding = packing_of(header->voxels.files.front());
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<VolumeHeader> parse_nifti_header(const std::filesystem::path& file) {
  const auto bytes = read_header_bytes(file);
  if (!bytes.ok()) return bytes.status();
  const auto fields = parse_nifti_fields(*bytes);
  if (!fields)
    return bad_volume(file,
                      "is not NIfTI: its header is too short, or has another length or magic than NIfTI-1 and -2");
  VolumeHeader header;
  const auto sizes = sizes_of(file, *fields);
  if (!sizes.ok()) return sizes.status();
  header.size = *sizes;
  header.big_endian = fields->big_endian;
  header.vtk_type = vtk_type_of(fields->datatype);
  if (header.vtk_type == 0)
    return bad_volume(file, absl::StrCat("has datatype ", fields->datatype, ", which is not a scalar type"));
  header.bytes_per_voxel = static_cast<uint64_t>(vtkDataArray::GetDataTypeSize(header.vtk_type));
  if (auto status = set_files(file, *fields, &header); !status.ok()) return status;
  set_nifti_scaling(*fields, &header);
  if (auto status = set_nifti_geometry(file, *fields, &header); !status.ok()) return status;
  return header;
}

}  // namespace lipofill::client
