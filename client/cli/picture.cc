#include "client/cli/picture.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "client/cli/process.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

constexpr char kNoScreen[] =
    "drawing needs an X server: install one without a screen by 'apt-get install xvfb xauth libgl1-mesa-dri'";

bool has_display() {
  const char* display = std::getenv("DISPLAY");
  return display != nullptr && *display != '\0';
}

/// Checks that the picture can be written. This comes first, as the drawing process would write
/// what its libraries say of it.
absl::Status check_can_be_written(const std::filesystem::path& png) {
  const std::filesystem::path folder = png.has_parent_path() ? png.parent_path() : ".";
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("cannot write ", png.string(), ": ", folder.string(), ": ", std::strerror(errno)));
}

absl::Status run_drawing(const std::vector<std::string>& command) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder.path() / "log";
  const auto code = run_process(command, log);
  if (!code.ok()) return code.status();
  if (*code == 0) return absl::OkStatus();
  const std::string text = read_text_file(log).value_or("");
  const std::string message =
      absl::StrCat("the picture could not be drawn (exit code ", *code, ")", text.empty() ? "" : ": ", text);
  // An error that the drawing process reports is in the input; anything else that ends it is due to
  // the screen.
  return *code == 2 ? absl::InvalidArgumentError(message) : absl::FailedPreconditionError(message);
}

}  // namespace

absl::Status draw_picture(const std::filesystem::path& folder, Picture picture, const std::filesystem::path& png) {
  if (const absl::Status writable = check_can_be_written(png); !writable.ok()) return writable;
  std::vector<std::string> command = {this_program().string(), "render", folder.string(), "--out", png.string(),
                                      "--in-this-process"};
  if (picture == Picture::kDistance) command.push_back("--distance");
  if (picture == Picture::kScan) command.push_back("--scan");
  if (picture == Picture::kDeficit) command.push_back("--deficit");
  if (picture == Picture::kReport) command.push_back("--report");
  if (picture == Picture::kFilm) command.push_back("--film");
  if (picture == Picture::kThickness) command.push_back("--thickness");
  absl::Status status = absl::FailedPreconditionError(kNoScreen);
  if (has_display()) status = run_drawing(command);
  if (!absl::IsFailedPrecondition(status)) return status;
  const std::filesystem::path xvfb = find_program("xvfb-run");
  if (xvfb.empty())
    return absl::FailedPreconditionError(absl::StrCat(kNoScreen, has_display() ? ", or mend $DISPLAY" : ""));
  // Without -noreset the server begins anew after each picture, and the next may not reach it.
  command.insert(command.begin(), {xvfb.string(), "-a", "-s", "-screen 0 1280x1024x24 -noreset"});
  return run_drawing(command);
}

}  // namespace lipofill::client
