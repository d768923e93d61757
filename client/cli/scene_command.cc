#include "client/cli/scene_command.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/options.h"
#include "client/cli/run_record.h"
#include "client/cli/scene_film.h"
#include "client/cli/units.h"
#include "client/cpp/json_file.h"
#include "client/cpp/scene/glb_scene.h"
#include "client/cpp/scene/scan_colours.h"
#include "client/cpp/scene/slicer_scene.h"
#include "client/cpp/scene/tissue_fields.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "A result as a scene for other programs. RESULT is a folder of lipofill run or lipofill export; a run leaves every "
    "still in it, an export the last alone.\n"
    "FILE.glb (glTF 2.0, for viewers, Blender, slides and web pages) has the skin in colours and its motion as an "
    "animation. FILE.mrml (3D Slicer) has the skin before and as planned, with lift_mm and pressure_pa on it, and the "
    "landmarks given, all in LPS; its other files lie beside it. FILE.vtu (ParaView) has the tissue, with layer, "
    "strain and "
    "stress at the middle of each hexahedron; --deck names the tissue's deck, of lipofill export --deck, which knows "
    "the "
    "layers. FILE.mp4 or FILE.webm is a film of the rise, for slides; it takes the program ffmpeg, and needs no "
    "screen.";

struct Options {
  std::string result;
  std::string out;
  std::string landmarks;
  std::string deck;
  std::string scan;
  v1::ScanUnit unit = v1::MILLIMETRE;
  std::string colour = "lift";
  size_t stills = 30;
  double play_s = 0.0;
};

absl::Status write_glb(const RunRecord& record, const SkinMotion& motion, const Options& options) {
  GlbOptions glb;
  glb.name = record.plan;
  glb.by_pressure = options.colour == "pressure";
  glb.play_s = options.play_s;
  glb.up = record.up;
  if (!options.scan.empty()) {
    const auto scan = read_scan_colours(options.scan, millimetres_of(options.unit));
    if (!scan.ok()) return scan.status();
    auto colours = find_nearest_colours(*scan, motion.rest_mm);
    if (!colours.ok()) return colours.status();
    glb.colours = *std::move(colours);
  }
  return write_text_file(options.out, glb_of(motion, glb));
}

absl::Status write_mrml(const SkinMotion& motion, const Options& options) {
  std::optional<Landmarks> landmarks;
  if (!options.landmarks.empty()) {
    auto loaded = load_landmarks(options.landmarks, v1::MILLIMETRE);
    if (!loaded.ok()) return loaded.status();
    landmarks = *std::move(loaded);
  }
  return write_slicer_scene(options.out, motion, landmarks);
}

absl::StatusOr<ExitCode> write_tissue(const Application& application, const Options& options) {
  if (options.deck.empty())
    return absl::InvalidArgumentError("a .vtu needs --deck FILE.inp, which lipofill export --deck writes");
  if (auto status = write_tissue_fields(options.result, options.deck, options.out); !status.ok()) return status;
  return application.done(absl::StrCat("wrote the tissue of ", options.result, " to ", options.out));
}

absl::StatusOr<ExitCode> film(const Application& application, const Options& options) {
  if (options.colour != "lift") return absl::InvalidArgumentError("a film shows the lift: --colour is for a .glb");
  if (auto status = write_film(options.result, options.out, {options.stills, options.play_s}); !status.ok())
    return status;
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"file", options.out}}.dump(2) << "\n";
    return ExitCode::kOk;
  }
  return application.done(absl::StrCat("filmed ", options.result, " as ", options.out));
}

absl::StatusOr<ExitCode> write(const Application& application, const Options& options) {
  if (absl::EndsWithIgnoreCase(options.out, ".vtu")) return write_tissue(application, options);
  if (is_film(options.out)) return film(application, options);
  const bool is_glb = absl::EndsWithIgnoreCase(options.out, ".glb");
  if (!is_glb && !absl::EndsWithIgnoreCase(options.out, ".mrml"))
    return absl::InvalidArgumentError(
        absl::StrCat("--out ", options.out, " must end in .glb, .mrml, .vtu, .mp4 or .webm"));
  const auto record = read_run_record(options.result);
  if (!record.ok()) return record.status();
  const auto motion = read_skin_motion(options.result, options.stills);
  if (!motion.ok()) return motion.status();
  const absl::Status written = is_glb ? write_glb(*record, *motion, options) : write_mrml(*motion, options);
  if (!written.ok()) return written;
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"file", options.out},
                                        {"points", motion->rest_mm.cols()},
                                        {"triangles", motion->triangles.size()},
                                        {"stills", motion->stills.size()}}
                     .dump(2)
              << "\n";
    return ExitCode::kOk;
  }
  return application.done(absl::StrFormat("%s: %d points, %d triangles, %d stills", options.out, motion->rest_mm.cols(),
                                          motion->triangles.size(), motion->stills.size()));
}

}  // namespace

void add_scene_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_local_command(root, application, "scene", kDescription,
                                        "  lipofill scene result --out face.glb\n"
                                        "  lipofill scene result --out face.glb --colour pressure --play-s 6\n"
                                        "  lipofill scene result --out face.glb --scan face.ply\n"
                                        "  lipofill scene result --out rise.mp4 --play-s 6\n"
                                        "  lipofill scene result --out face.mrml --landmarks face.mrk.json\n"
                                        "  lipofill scene result --out tissue.vtu --deck tissue.inp\n",
                                        [&application, options] { return write(application, *options); });
  command->add_option("result", options->result, "folder of a run or an export")->required();
  command->add_option("--out", options->out, "file to write")
      ->required()
      ->type_name("FILE.glb|FILE.mrml|FILE.vtu|FILE.mp4|FILE.webm");
  command->add_option("--colour", options->colour, "what colours a GLB: lift (default) or pressure")
      ->check(CLI::IsMember({"lift", "pressure"}).description(""));
  command->add_option("--scan", options->scan,
                      "colour a GLB by the vertices of this scan, the one the plan was made on: .ply, .obj, .glb or "
                      ".gltf");
  command->add_option("--unit", options->unit, "unit of that scan: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  command->add_option("--stills", options->stills, "at most so many stills of the motion; default 30")
      ->check(CLI::Range(1, 1000).description(""))
      ->type_name("NUMBER");
  command
      ->add_option("--play-s", options->play_s,
                   "play the motion in so many seconds; default: as long as it took, a film 4")
      ->check(CLI::Range(0.01, 3600.0).description(""))
      ->type_name("SECONDS");
  command->add_option("--landmarks", options->landmarks, "landmarks to put into a scene of Slicer, mm and LPS");
  command->add_option("--deck", options->deck, "the tissue's deck, for a .vtu")->type_name("FILE.inp");
}

}  // namespace lipofill::client
