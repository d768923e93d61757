#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cpp/volume/invesalius.h"
#include "client/cpp/volume/skin_extraction.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string volume;
  std::string out;
  SkinExtraction extraction;
};

constexpr char kExtractDescription[] =
    "The skin in a CT or MRI volume: the surface at a value, as triangles in millimetres.\n"
    "Reads MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr) and NIfTI-1 (.nii, .nii.gz) with their orientation. The surface "
    "is in the "
    "patient's LPS axes: x to the left, y to the back, z up (NIfTI's and NRRD's RAS are turned to LPS); a NRRD without "
    "a space or a NIfTI "
    "without qform and sform stays in its own axes, which the answer says. Axes for a landmarks file in LPS: left "
    "[1,0,0], "
    "up [0,0,1], forward [0,-1,0].\n"
    "In a head CT the skin at -300 HU opens into the airways and sinuses; the largest connected piece, which is taken, "
    "has their "
    "walls too. The model builder takes what is seen from outside.\n"
    "The bone is extracted the same way, at +250 HU, with --all: jaw and skull are separate pieces. As a plan's bone "
    "it "
    "says how deep the tissue is.";

absl::StatusOr<ExitCode> extract(const Application& application, const Options& options) {
  const auto skin = extract_skin(options.volume, options.out, options.extraction);
  if (!skin.ok()) return skin.status();
  const auto& b = skin->bounds_mm;
  if (application.json) {
    const nlohmann::ordered_json answer = {{"file", options.out},
                                           {"vertices", skin->vertices},
                                           {"triangles", skin->triangles},
                                           {"components", skin->components},
                                           {"bounds_mm", b},
                                           {"frame", skin->frame},
                                           {"isovalue", options.extraction.isovalue}};
    std::cout << answer.dump(2) << "\n";
  } else {
    std::cout << absl::StrFormat(
        "%s: %d vertices, %d triangles, from %d connected pieces at the value %g\n  x %.1f to %.1f, y %.1f to %.1f, z "
        "%.1f to %.1f "
        "mm; axes: %s\n",
        options.out, skin->vertices, skin->triangles, skin->components, options.extraction.isovalue, b[0], b[1], b[2],
        b[3], b[4], b[5], skin->frame == "LPS" ? "LPS (x to the left, y to the back, z up)" : skin->frame);
  }
  return ExitCode::kOk;
}

absl::StatusOr<ExitCode> convert(const Application& application, const Options& options) {
  const auto volume = convert_invesalius(options.volume, options.out);
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
  } else {
    std::cout << absl::StrFormat(
        "%s: %d x %d x %d voxels of %.4g x %.4g x %.4g mm, axes LPS (x to the left, y to the back, z up)\n",
        options.out, size[0], size[1], size[2], spacing[0], spacing[1], spacing[2]);
  }
  return ExitCode::kOk;
}

}  // namespace

void add_volume_commands(CLI::App& scan, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      add_local_command(scan, application, "extract", kExtractDescription,
                        "  lipofill scan extract head.mha --isovalue -300 --out skin.ply\n"
                        "  lipofill scan extract head.mha --isovalue 250 --all --out bone.ply\n"
                        "  lipofill scan extract head.nii.gz --out skin.stl --smooth 20 --triangles 200000\n",
                        [&application, options] { return extract(application, *options); });
  command->add_option("volume", options->volume, ".mha, .mhd, .nrrd, .nhdr, .nii or .nii.gz")->required();
  command->add_option("--out", options->out, ".obj, .ply or .stl")->required();
  command
      ->add_option("--isovalue", options->extraction.isovalue,
                   "in the volume's values; -300 (the default) is the skin in HU, 250 the bone")
      ->capture_default_str();
  command->add_flag("--all", options->extraction.all_components,
                    "take every piece, not only the largest connected one");
  command
      ->add_option("--smooth", options->extraction.smoothing_iterations,
                   "iterations of windowed-sinc smoothing; the volume stays as it is")
      ->check(CLI::Range(0, 1000));
  command->add_option("--triangles", options->extraction.target_triangles, "thin out to about as many triangles")
      ->check(CLI::Range(uint64_t{100}, uint64_t{100'000'000}));
  command =
      add_local_command(scan, application, "convert",
                        "The volume of an InVesalius 3 project as a MetaImage in LPS axes, the head not mirrored.",
                        "  lipofill scan convert Cranium.inv3 --out ct.mha\n",
                        [&application, options] { return convert(application, *options); });
  command->add_option("project", options->volume, ".inv3")->required();
  command->add_option("--out", options->out, ".mha")->required();
}

}  // namespace lipofill::client
