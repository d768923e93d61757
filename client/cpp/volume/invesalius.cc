#include "client/cpp/volume/invesalius.h"

#include <vtkNew.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <cmath>
#include <fstream>
#include <map>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/io/vtk_messages.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/tar_archive.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {
namespace {

constexpr uint64_t kMaxPlistBytes = 1 << 20;

std::string text_of(vtkXMLDataElement* element) {
  const char* data = element != nullptr ? element->GetCharacterData() : nullptr;
  return data != nullptr ? std::string(absl::StripAsciiWhitespace(data)) : std::string();
}

/// The value after <key>name</key> in a property list's <dict>.
vtkXMLDataElement* value_of(vtkXMLDataElement* dict, const std::string& name) {
  for (int i = 0; dict != nullptr && i + 1 < dict->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* key = dict->GetNestedElement(i);
    if (std::string_view(key->GetName()) == "key" && text_of(key) == name) return dict->GetNestedElement(i + 1);
  }
  return nullptr;
}

std::vector<double> numbers_of(vtkXMLDataElement* array) {
  std::vector<double> numbers;
  for (int i = 0; array != nullptr && i < array->GetNumberOfNestedElements(); ++i) {
    double number = 0.0;
    if (!absl::SimpleAtod(text_of(array->GetNestedElement(i)), &number) || !std::isfinite(number)) return {};
    numbers.push_back(number);
  }
  return numbers;
}

absl::StatusOr<std::string> read_plist(const std::filesystem::path& project) {
  auto tar = TarArchive::open(project);
  if (!tar.ok()) return absl::InvalidArgumentError(absl::StrCat("not an InVesalius project: ", tar.status().message()));
  const auto size = tar->find("main.plist");
  if (!size.ok())
    return absl::InvalidArgumentError(absl::StrCat("not an InVesalius project: ", size.status().message()));
  if (*size > kMaxPlistBytes) {
    return bad_volume(project,
                      absl::StrCat("has a main.plist of ", *size, " bytes, must have at most ", kMaxPlistBytes));
  }
  std::string text(*size, '\0');
  if (auto status = tar->read(text.data(), text.size()); !status.ok()) return status;
  return text;
}

struct Project {
  InvesaliusVolume volume;
  std::string matrix_file;
};

absl::StatusOr<Project> parse_project(const std::filesystem::path& file, const std::string& plist) {
  const VtkMessages messages;
  const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromString(plist.c_str()));
  vtkXMLDataElement* dict = root != nullptr ? root->FindNestedElementWithName("dict") : nullptr;
  vtkXMLDataElement* matrix = value_of(dict, "matrix");
  const std::vector<double> shape = numbers_of(value_of(matrix, "shape"));
  const std::vector<double> spacing = numbers_of(value_of(dict, "spacing"));
  if (shape.size() != 3 || spacing.size() != 3)
    return bad_volume(file, "has no matrix of three sizes and spacings in its main.plist");
  if (text_of(value_of(matrix, "dtype")) != "int16") return bad_volume(file, "has a matrix that is not int16");
  const std::string orientation = text_of(value_of(dict, "orientation"));
  if (!orientation.empty() && orientation != "1")
    return bad_volume(file, absl::StrCat("has orientation ", orientation, ", not 1 (axial)"));
  Project project;
  project.matrix_file = text_of(value_of(matrix, "filename"));
  const auto shapes = parse_sizes(file, "shape", absl::StrCat(shape[2], " ", shape[1], " ", shape[0]));
  if (!shapes.ok()) return shapes.status();
  const auto sizes = three_sizes(file, "shape", *shapes);
  if (!sizes.ok()) return sizes.status();
  project.volume.size = *sizes;
  for (size_t i = 0; i < 3; ++i) {
    if (!(spacing[i] > 0.0 && spacing[i] < 100.0))
      return bad_volume(file, absl::StrCat("has spacing ", spacing[i], " mm, not in (0, 100)"));
    project.volume.spacing_mm[i] = spacing[i];
  }
  return project;
}

std::string metaimage_header(const InvesaliusVolume& volume) {
  const auto& [columns, rows, slices] = volume.size;
  const auto& [dx, dy, dz] = volume.spacing_mm;
  return absl::StrFormat(
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 %.9g 0\nAnatomicalOrientation = RAI\nElementSpacing = %.9g %.9g "
      "%.9g\n"
      "DimSize = %d %d %d\nElementType = MET_SHORT\nElementDataFile = LOCAL\n",
      -dy * static_cast<double>(rows - 1), dx, dy, dz, columns, rows, slices);
}

absl::Status write_metaimage(TarArchive* matrix, const InvesaliusVolume& volume, const std::filesystem::path& out) {
  const auto& [columns, rows, slices] = volume.size;
  const size_t row_bytes = columns * sizeof(int16_t);
  std::vector<char> slice(row_bytes * rows);
  std::ofstream stream(out, std::ios::binary);
  stream << metaimage_header(volume);
  for (uint64_t k = 0; stream && k < slices; ++k) {
    if (auto status = matrix->read(slice.data(), slice.size()); !status.ok()) return status;
    for (size_t row = rows; row-- > 0;)
      stream.write(slice.data() + row * row_bytes, static_cast<std::streamsize>(row_bytes));
  }
  stream.close();
  if (!stream) return absl::InvalidArgumentError(absl::StrCat("cannot write ", out.string()));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<InvesaliusVolume> convert_invesalius(const std::filesystem::path& file,
                                                    const std::filesystem::path& out) {
  if (absl::AsciiStrToLower(out.extension().string()) != ".mha") {
    return absl::InvalidArgumentError(absl::StrCat("output ", out.string(), " is not a .mha"));
  }
  const auto plist = read_plist(file);
  if (!plist.ok()) return plist.status();
  const auto project = parse_project(file, *plist);
  if (!project.ok()) return project.status();
  auto tar = TarArchive::open(file);
  if (!tar.ok()) return tar.status();
  const auto found = tar->find(project->matrix_file);
  if (!found.ok()) return absl::InvalidArgumentError(found.status().message());
  const auto& size = project->volume.size;
  const uint64_t expected = size[0] * size[1] * size[2] * sizeof(int16_t);
  if (*found != expected || expected > kMaxVolumeBytes) {
    return bad_volume(file,
                      absl::StrCat("has a matrix of ", *found, " bytes where its main.plist asks for ", expected));
  }
  if (auto status = write_metaimage(&*tar, project->volume, out); !status.ok()) {
    std::error_code error;
    std::filesystem::remove(out, error);
    return status;
  }
  return project->volume;
}

}  // namespace lipofill::client
