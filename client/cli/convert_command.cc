#include "client/cli/convert_command.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/options.h"
#include "client/cli/units.h"
#include "client/cpp/gltf/gltf_surface.h"
#include "client/cpp/json_file.h"
#include "client/cpp/volume/invesalius.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Files of other programs as files that a scan is read from.\n"
    "A .glb or .gltf (glTF 2.0) becomes a .ply in mm with the colours of its vertices; all meshes of its scene are "
    "taken where their nodes put them, textures, skins and morph targets are passed over. The format has metres: a "
    "surface smaller than 5 units is taken so, a larger one as --unit says. Packed files (Draco, meshopt) are refused; "
    "export them without compression.\n"
    "The volume of an InVesalius 3 project becomes a MetaImage in LPS axes, the head not mirrored.";

struct Options {
  std::string file;
  std::string out;
  v1::ScanUnit unit = v1::MILLIMETRE;
};

absl::StatusOr<ExitCode> convert_gltf(const Application& application, const Options& options) {
  if (!absl::EndsWithIgnoreCase(options.out, ".ply"))
    return absl::InvalidArgumentError(absl::StrCat("--out ", options.out, " must end in .ply"));
  auto surface = read_gltf_surface(options.file);
  if (!surface.ok()) return surface.status();
  const double mm = gltf_unit_mm(*surface, millimetres_of(options.unit));
  std::vector<std::string> remarks = surface->remarks;
  remarks.push_back(absl::StrFormat("its numbers are taken for units of %g mm", mm));
  if (auto status = write_text_file(options.out, ply_bytes(*surface, mm)); !status.ok()) return status;
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"file", options.out},
                                        {"points", surface->points.size()},
                                        {"triangles", surface->triangles.size()},
                                        {"coloured", !surface->colours.empty()},
                                        {"mm_per_unit", mm},
                                        {"remarks", remarks}}
                     .dump(2)
              << "\n";
    return ExitCode::kOk;
  }
  std::cout << absl::StrFormat("%s: %d points, %d triangles, %s colours\n", options.out, surface->points.size(),
                               surface->triangles.size(), surface->colours.empty() ? "no" : "with");
  for (const std::string& remark : remarks) std::cout << "  remark: " << remark << "\n";
  return ExitCode::kOk;
}

absl::StatusOr<ExitCode> convert_project(const Application& application, const Options& options) {
  const auto volume = convert_invesalius(options.file, options.out);
  if (!volume.ok()) return volume.status();
  const auto& size = volume->size;
  const auto& spacing = volume->spacing_mm;
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"file", options.out},
                                        {"size", size},
                                        {"spacing_mm", spacing},
                                        {"frame", "LPS"}}
                     .dump(2)
              << "\n";
    return ExitCode::kOk;
  }
  std::cout << absl::StrFormat(
      "%s: %d x %d x %d voxels of %.4g x %.4g x %.4g mm, axes LPS (x to the left, y to the back, z up)\n", options.out,
      size[0], size[1], size[2], spacing[0], spacing[1], spacing[2]);
  return ExitCode::kOk;
}

}  // namespace

void add_convert_command(CLI::App& scan, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_local_command(
      scan, application, "convert", kDescription,
      "  lipofill scan convert face.glb --out face.ply\n  lipofill scan convert Cranium.inv3 --out ct.mha\n",
      [&application, options] {
        return is_gltf_name(options->file) ? convert_gltf(application, *options)
                                           : convert_project(application, *options);
      });
  command->add_option("file", options->file, ".glb, .gltf or .inv3")->required();
  command->add_option("--out", options->out, ".ply for a surface, .mha for a volume")->required();
  command
      ->add_option("--unit", options->unit, "unit of a glTF surface that is larger than 5 units: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
}

}  // namespace lipofill::client
