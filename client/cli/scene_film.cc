#include "client/cli/scene_film.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/picture.h"
#include "client/cli/process.h"
#include "client/cpp/json_file.h"
#include "client/cpp/picture/panels.h"
#include "client/cpp/picture/surface.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

constexpr char kOrder[] = "film.json";
/// Codecs want even numbers.
constexpr int kWidth = 960, kHeight = 960;
constexpr int kTitleSize = 30, kTextSize = 22;

/// The skin at a time, with the displacement and its length on it. Its middle lies at the origin:
/// pictures are drawn in single precision.
class MovingSkin {
 public:
  explicit MovingSkin(SkinMotion motion) : motion_(std::move(motion)) {
    const Eigen::Vector3d middle = motion_.rest_mm.rowwise().mean();
    motion_.rest_mm.colwise() -= middle;
    // A shape that was found directly has no times.
    has_times_ = motion_.stills.back().time_s > 0.0;
    if (!has_times_) motion_.stills.back().time_s = 1.0;
    cells_ = vtkSmartPointer<vtkCellArray>::New();
    for (const auto& triangle : motion_.triangles) {
      const std::array<vtkIdType, 3> corners = {triangle[0], triangle[1], triangle[2]};
      cells_->InsertNextCell(3, corners.data());
    }
  }

  double end_s() const { return motion_.stills.back().time_s; }
  bool has_times() const { return has_times_; }

  Surface at(double time_s) const {
    const Eigen::Matrix3Xd moved = displacement_at(time_s);
    const auto points = vtkSmartPointer<vtkPoints>::New();
    const auto field = vtkSmartPointer<vtkDoubleArray>::New();
    field->SetName(kDisplacement);
    field->SetNumberOfComponents(3);
    for (Eigen::Index k = 0; k < moved.cols(); ++k) {
      const Eigen::Vector3d place = motion_.rest_mm.col(k) + moved.col(k);
      points->InsertNextPoint(place.data());
      field->InsertNextTuple(moved.col(k).data());
    }
    auto surface = Surface::New();
    surface->SetPoints(points);
    surface->SetPolys(cells_);
    surface->GetPointData()->AddArray(field);
    add_displacement_length(surface);
    return with_normals(surface);
  }

 private:
  /// Displacement is linear between stills, from rest at time 0.
  Eigen::Matrix3Xd displacement_at(double time_s) const {
    const auto after = std::find_if(motion_.stills.begin(), motion_.stills.end(),
                                    [time_s](const SkinStill& still) { return still.time_s >= time_s; });
    if (after == motion_.stills.end()) return motion_.stills.back().displacement_mm.cast<double>();
    const bool is_first = after == motion_.stills.begin();
    const double before_s = is_first ? 0.0 : std::prev(after)->time_s;
    const double span = after->time_s - before_s;
    const double part = span > 0.0 ? (time_s - before_s) / span : 1.0;
    const Eigen::Matrix3Xd later = part * after->displacement_mm.cast<double>();
    if (is_first) return later;
    return later + (1.0 - part) * std::prev(after)->displacement_mm.cast<double>();
  }

  SkinMotion motion_;
  bool has_times_ = true;
  vtkSmartPointer<vtkCellArray> cells_;
};

absl::Status draw_frame(const Surface& surface, const View& view, vtkColorTransferFunction* colours,
                        const std::string& title, const std::string& time, const std::filesystem::path& png) {
  Sheet sheet{kWidth, kHeight, {}, {}};
  sheet.panels = {
      panel({0.0, 0.06, 0.86, 0.92}, surface, view, {Paint::Kind::kPointField, kDisplacementLength, colours})};
  sheet.overlay.add_text(title, kTitleSize, 0.02, 0.96);
  sheet.overlay.add_text(time, kTitleSize, 0.98, 0.96, Overlay::Align::kRight);
  sheet.overlay.add_text("mm", kTextSize, 0.88, 0.87);
  sheet.overlay.add_bar({0.88, 0.25, 0.91, 0.83}, colours);
  sheet.overlay.add_text(kNotAMedicalDevice, 16, 0.02, 0.025);
  return write_png(png, sheet);
}

std::vector<std::string> joining_command(const std::filesystem::path& ffmpeg, const std::filesystem::path& frames,
                                         const std::filesystem::path& out) {
  std::vector<std::string> command = {ffmpeg.string(),
                                      "-nostdin",
                                      "-loglevel",
                                      "error",
                                      "-y",
                                      "-framerate",
                                      absl::StrCat(kFramesPerSecond),
                                      "-i",
                                      (frames / "%05d.png").string()};
  const bool is_webm = absl::EndsWithIgnoreCase(out.string(), ".webm");
  const std::vector<std::string> codec =
      is_webm ? std::vector<std::string>{"-c:v", "libvpx-vp9", "-crf", "32", "-b:v", "0"}
              : std::vector<std::string>{"-c:v", "libx264", "-crf", "20", "-movflags", "+faststart"};
  command.insert(command.end(), codec.begin(), codec.end());
  // One thread and no date of writing: the same frames are the same file.
  for (const char* each : {"-pix_fmt", "yuv420p", "-threads", "1", "-fflags", "+bitexact", "-flags:v", "+bitexact",
                           "-map_metadata", "-1", "-an"})
    command.push_back(each);
  command.push_back(out.string());
  return command;
}

}  // namespace

bool is_film(const std::filesystem::path& file) {
  return absl::EndsWithIgnoreCase(file.string(), ".mp4") || absl::EndsWithIgnoreCase(file.string(), ".webm");
}

absl::Status draw_film_frames(const std::filesystem::path& folder) {
  const auto order = read_json_file(folder / kOrder);
  if (!order.ok()) return order.status();
  const std::filesystem::path result = order->at("result").get<std::string>();
  const auto record = read_run_record(result);
  if (!record.ok()) return record.status();
  auto motion = read_skin_motion(result, order->at("stills").get<size_t>());
  if (!motion.ok()) return motion.status();
  const MovingSkin skin(*std::move(motion));
  const Surface last = skin.at(skin.end_s());
  const View view = view_of(last, kDisplacement, record->up);
  const auto colours = displacement_colours(largest_size(last, kDisplacement));
  const int moving = std::max(2, static_cast<int>(std::lround(order->at("play_s").get<double>() * kFramesPerSecond)));
  const int standing = static_cast<int>(std::lround(kStandS * kFramesPerSecond));
  for (int k = 0; k < moving; ++k) {
    const double time_s = skin.end_s() * k / (moving - 1);
    const auto png = folder / absl::StrFormat("%05d.png", k);
    const std::string time = skin.has_times() ? absl::StrFormat("%.1f s", time_s) : "";
    const absl::Status status = draw_frame(skin.at(time_s), view, colours, record->plan, time, png);
    if (!status.ok()) return status;
  }
  std::error_code error;
  for (int k = 0; k < standing && !error; ++k) {
    std::filesystem::copy_file(folder / absl::StrFormat("%05d.png", moving - 1),
                               folder / absl::StrFormat("%05d.png", moving + k), error);
  }
  if (error) return absl::ResourceExhaustedError(absl::StrCat("cannot write a frame: ", error.message()));
  return absl::OkStatus();
}

absl::Status write_film(const std::filesystem::path& result, const std::filesystem::path& out,
                        const FilmOptions& options) {
  const std::filesystem::path ffmpeg = find_program("ffmpeg");
  if (ffmpeg.empty())
    return absl::FailedPreconditionError("a film needs the program ffmpeg: install it by 'apt-get install ffmpeg'");
  // What is wrong with the folder is told before a screen is looked for.
  if (const auto motion = read_skin_motion(result, 1); !motion.ok()) return motion.status();
  const TemporaryFolder frames;
  const nlohmann::json order = {{"result", std::filesystem::absolute(result).string()},
                                {"stills", options.stills},
                                {"play_s", options.play_s > 0.0 ? options.play_s : kUsualPlayS}};
  if (auto written = write_text_file(frames.path() / kOrder, order.dump()); !written.ok()) return written;
  const absl::Status drawn = draw_picture(frames.path(), Picture::kFilm, frames.path() / "frames");
  if (!drawn.ok()) return drawn;
  const std::filesystem::path log = frames.path() / "log";
  const auto code = run_process(joining_command(ffmpeg, frames.path(), out), log);
  if (!code.ok()) return code.status();
  if (*code == 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("ffmpeg could not write ", out.string(), ": ", read_text_file(log).value_or("")));
}

}  // namespace lipofill::client
