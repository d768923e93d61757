#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/picture.h"
#include "client/cli/run_record.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/picture/result_picture.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string folder;
  std::string out;
  bool distance = false;
  bool in_this_process = false;
};

absl::Status draw_here(const Options& options) {
  const auto record = read_run_record(options.folder);
  if (!record.ok()) return record.status();
  PictureRequest request;
  request.png = options.out;
  request.up = record->up;
  request.caption = absl::StrCat(record->plan, ".  ", kNotAMedicalDevice);
  if (options.distance) {
    request.mesh = std::filesystem::path(options.folder) / "distance.vtp";
    return draw_distance_picture(request);
  }
  request.mesh = last_frame_file(options.folder, "scan");
  if (request.mesh.empty()) request.mesh = last_frame_file(options.folder, "skin");
  if (request.mesh.empty())
    return absl::InvalidArgumentError(absl::StrCat(options.folder, " holds no scan_NNNN.vtp or skin_NNNN.vtp"));
  return draw_result_picture(request);
}

absl::StatusOr<ExitCode> picture(const Application& application, Options options) {
  if (options.out.empty())
    options.out =
        (std::filesystem::path(options.folder) / (options.distance ? "distance.png" : "picture.png")).string();
  const absl::Status status =
      options.in_this_process
          ? draw_here(options)
          : draw_picture(options.folder, options.distance ? Picture::kDistance : Picture::kResult, options.out);
  if (!status.ok()) return status;
  return options.in_this_process ? ExitCode::kOk : application.done(absl::StrCat("drew ", options.out));
}

}  // namespace

void add_picture_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      add_local_command(root, application, "picture", "Draw a folder of results: before, after and displacement",
                        "  lipofill picture result\n  lipofill picture result --out figure.png\n",
                        [&application, options] { return picture(application, *options); });
  command->add_option("folder", options->folder, "what lipofill run or export wrote")
      ->required()
      ->check(CLI::ExistingDirectory);
  command->add_option("--out", options->out, "default: picture.png in the folder");
  command->add_flag("--distance", options->distance,
                    "the distance to the target that lipofill evaluate found, as distance.png");
  // Hidden: the child that lipofill starts under an X server.
  command->add_flag("--in-this-process", options->in_this_process)->group("");
}

}  // namespace lipofill::client
