#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "client/cli/application.h"
#include "client/cli/deficit_sheet.h"
#include "client/cli/picture.h"
#include "client/cli/process.h"
#include "client/cli/report_pictures.h"
#include "client/cli/result_figures.h"
#include "client/cli/result_files.h"
#include "client/cli/run_record.h"
#include "client/cli/scene_film.h"
#include "client/cli/thickness_sheet.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/json_file.h"
#include "client/cpp/picture/deficit_picture.h"
#include "client/cpp/picture/result_picture.h"
#include "client/cpp/picture/scan_picture.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Draw a result on one sheet, a PNG: the face before and after, the displacement of the skin in mm, and the "
    "pressure "
    "of the fat in bands of mmHg (below 9, 9 to 15, 15 to 30, above 30; meant for settled fat), with the figures of "
    "every zone. Colours stay in order without colour vision. Works without a screen, through xvfb-run.";

constexpr char kExamples[] =
    "  lipofill render result                                  writes result/picture.png\n"
    "  lipofill render result --out figure.png\n"
    "  lipofill render simulations/abc --out figure.png        of a simulation that has ended, from its daemon\n"
    "  lipofill render result --distance                       what lipofill evaluate found, as result/distance.png\n";

struct Options {
  std::string result;
  std::string out;
  bool distance = false;
  bool scan = false;
  bool deficit = false;
  bool report = false;
  bool thickness = false;
  bool film = false;
  bool in_this_process = false;
};

absl::Status draw_scan_here(const Options& options) {
  const std::filesystem::path folder(options.result);
  const auto text = read_text_file(folder / kTextToDraw);
  if (!text.ok()) return text.status();
  PictureRequest request;
  request.mesh = folder / kScanToDraw;
  request.png = options.out;
  request.caption = kNotAMedicalDevice;
  for (const auto line : absl::StrSplit(*text, '\n', absl::SkipEmpty())) request.remarks.emplace_back(line);
  return draw_scan_picture(request);
}

absl::Status draw_deficit_here(const Options& options) {
  auto request = read_deficit_request(options.result);
  if (!request.ok()) return request.status();
  request->png = options.out;
  return draw_deficit_picture(*request);
}

absl::Status draw_thickness_here(const Options& options) {
  auto picture = read_thickness_picture(options.result);
  if (!picture.ok()) return picture.status();
  picture->png = options.out;
  return draw_thickness_picture(*picture);
}

absl::Status draw_here(const Options& options) {
  if (options.scan) return draw_scan_here(options);
  if (options.deficit) return draw_deficit_here(options);
  if (options.report) return draw_pictures_of_report(options.result);
  if (options.film) return draw_film_frames(options.result);
  if (options.thickness) return draw_thickness_here(options);
  const auto record = read_run_record(options.result);
  if (!record.ok()) return record.status();
  PictureRequest request;
  request.png = options.out;
  request.up = record->up;
  request.title = absl::StrReplaceAll(record->plan, {{"_", " "}});
  if (options.distance) {
    request.caption = absl::StrCat(record->plan, ".  ", kNotAMedicalDevice);
    request.mesh = std::filesystem::path(options.result) / "distance.vtp";
    return draw_distance_picture(request);
  }
  request.caption = kNotAMedicalDevice;
  request.figures = figures_of_folder(options.result);
  request.remarks = remarks_of_folder(options.result);
  request.mesh = last_frame_file(options.result, "scan");
  if (request.mesh.empty()) request.mesh = last_frame_file(options.result, "skin");
  if (request.mesh.empty())
    return absl::InvalidArgumentError(absl::StrCat(options.result, " holds no scan_NNNN.vtp or skin_NNNN.vtp"));
  return draw_result_picture(request);
}

/// Draws a simulation by its name: fetches its final state into a folder that is removed
/// afterwards.
absl::Status draw_simulation(Application& application, const Options& options) {
  if (options.out.empty())
    return absl::InvalidArgumentError("--out FILE.png is needed to draw a simulation by its name");
  if (options.distance)
    return absl::InvalidArgumentError("--distance draws a folder that lipofill evaluate wrote into");
  const TemporaryFolder folder;
  const auto exported = export_result(application.connect(), options.result, folder.path());
  if (!exported.ok()) return exported.status();
  return draw_picture(folder.path(), Picture::kResult, std::filesystem::absolute(options.out));
}

absl::Status draw_folder(Options& options) {
  const std::filesystem::path folder(options.result);
  if (options.out.empty()) options.out = (folder / (options.distance ? "distance.png" : "picture.png")).string();
  return draw_picture(folder, options.distance ? Picture::kDistance : Picture::kResult, options.out);
}

absl::StatusOr<ExitCode> render(Application& application, Options options) {
  if (options.in_this_process) {
    const absl::Status status = draw_here(options);
    if (!status.ok()) return status;
    return ExitCode::kOk;
  }
  const bool is_folder = std::filesystem::is_directory(options.result);
  const absl::Status status = is_folder ? draw_folder(options) : draw_simulation(application, options);
  if (!status.ok()) return status;
  return application.done(absl::StrCat("drew ", options.out));
}

}  // namespace

void add_render_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, application, "render", kDescription, kExamples,
                                  [&application, options] { return render(application, *options); });
  command
      ->add_option("result", options->result,
                   "a folder that lipofill run or export wrote, or the name of a simulation that has ended")
      ->required();
  command->add_option("--out", options->out, "file to write; default for a folder: picture.png in it")
      ->type_name("FILE.png");
  command->add_flag("--distance", options->distance,
                    "the distance to the target that lipofill evaluate found, in place of displacement and pressure");
  // These options are hidden: they are for the child that lipofill starts under an X server.
  command->add_flag("--scan", options->scan)->group("");
  command->add_flag("--deficit", options->deficit)->group("");
  command->add_flag("--report", options->report)->group("");
  command->add_flag("--thickness", options->thickness)->group("");
  command->add_flag("--film", options->film)->group("");
  command->add_flag("--in-this-process", options->in_this_process)->group("");
}

}  // namespace lipofill::client
