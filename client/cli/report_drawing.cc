// The process that draws the pictures of a report: what to draw is in files of its folder.

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "client/cli/report_pictures.h"
#include "client/cpp/json_file.h"
#include "client/cpp/picture/face_frame.h"
#include "client/cpp/picture/face_picture.h"

namespace lipofill::client {
namespace {

using Point3 = std::array<double, 3>;

const std::map<std::string, FacePaint> kPaints = {{"skin", FacePaint::kSkin},
                                                  {"displacement", FacePaint::kMovement},
                                                  {"pressure", FacePaint::kBands},
                                                  {"distance", FacePaint::kDistance}};

/// Reads each mesh once.
class Surfaces {
 public:
  explicit Surfaces(std::filesystem::path folder) : folder_(std::move(folder)) {}

  absl::StatusOr<Surface> find(const std::string& name) {
    if (const auto known = surfaces_.find(name); known != surfaces_.end()) return known->second;
    auto read = read_plain_surface(folder_ / name);
    if (read.ok()) surfaces_[name] = *read;
    return read;
  }

 private:
  std::filesystem::path folder_;
  std::map<std::string, Surface> surfaces_;
};

/// The camera of a map, or of a side of the face.
View view_for(const nlohmann::json& request, const nlohmann::json& picture, vtkPolyData* before, vtkPolyData* moved) {
  const auto& axes = request.at("axes");
  const FaceAxes face{axes.at("left").get<Point3>(), axes.at("up").get<Point3>(), axes.at("forward").get<Point3>()};
  if (!picture.contains("side")) {
    std::optional<Point3> up;
    if (request.at("is_face").get<bool>()) up = face.up;
    return view_of(with_normals(at_rest(moved)), kDisplacement, up);
  }
  std::optional<Point3> centre;
  if (request.contains("centre")) centre = request.at("centre").get<Point3>();
  return face_view(before, face, centre, static_cast<FaceSide>(picture.at("side").get<int>()));
}

}  // namespace

absl::Status draw_pictures_of_report(const std::filesystem::path& folder) {
  const auto request = read_json_file(folder / "pictures.json");
  if (!request.ok()) return request.status();
  Surfaces surfaces(folder);
  const auto before = surfaces.find("before.vtp");
  if (!before.ok()) return before.status();
  const auto moved = surfaces.find("planned.vtp");
  if (!moved.ok()) return moved.status();
  for (const nlohmann::json& asked : request->at("pictures")) {
    const auto surface = surfaces.find(asked.at("mesh").get<std::string>());
    if (!surface.ok()) return surface.status();
    FacePicture picture;
    picture.surface = *surface;
    picture.paint = kPaints.at(asked.at("paint").get<std::string>());
    picture.view = view_for(*request, asked, *before, *moved);
    picture.largest = asked.value("largest", 1.0);
    picture.line_step = asked.value("line_step", 1.0);
    picture.png = folder / (asked.at("name").get<std::string>() + ".png");
    if (auto drawn = draw_face_picture(picture); !drawn.ok()) return drawn;
  }
  return absl::OkStatus();
}

}  // namespace lipofill::client
