#include "client/cpp/scene/glb_scene.h"

#include <vtkColorTransferFunction.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/picture/colours.h"
#include "client/cpp/result_text.h"
#include "client/cpp/scene/glb_file.h"

namespace lipofill::client {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMetresPerMm = 1e-3;
constexpr double kLeastFatMm = 0.1;

/// glTF's colours are linear, the ones of the pictures as screens show them (IEC 61966-2-1).
float linear_of(double shown) {
  return static_cast<float>(shown <= 0.04045 ? shown / 12.92 : std::pow((shown + 0.055) / 1.055, 2.4));
}

/// Colours as screens show them, as glTF has them.
Eigen::Matrix4Xf linear_colours(const Eigen::Matrix3Xf& shown) {
  Eigen::Matrix4Xf values = Eigen::Matrix4Xf::Ones(4, shown.cols());
  values.topRows<3>() = shown.unaryExpr([](float value) { return linear_of(value); });
  return values;
}

Eigen::Matrix4Xf colours_of(const SkinMotion& motion, bool by_pressure) {
  const Eigen::VectorXf lift = motion.stills.back().displacement_mm.colwise().norm();
  const auto colours = displacement_colours(lift.maxCoeff());
  Eigen::Matrix4Xf values(4, lift.size());
  for (Eigen::Index k = 0; k < lift.size(); ++k) {
    const auto at = static_cast<size_t>(k);
    Colour colour = kNothing;
    if (!by_pressure)
      colours->GetColor(lift[k], colour.data());
    else if (motion.thickness_mm[at] > kLeastFatMm)
      colour = pressure_band_of(motion.pressure_pa[at]).colour;
    values.col(k) << linear_of(colour[0]), linear_of(colour[1]), linear_of(colour[2]), 1.0F;
  }
  return values;
}

/// Normals of the result by the areas of the triangles around each point.
Eigen::Matrix3Xf normals_of(const SkinMotion& motion, const Eigen::Matrix3Xf& points) {
  Eigen::Matrix3Xf normals = Eigen::Matrix3Xf::Zero(3, points.cols());
  for (const auto& [a, b, c] : motion.triangles) {
    const Eigen::Vector3f normal = (points.col(b) - points.col(a)).cross(points.col(c) - points.col(a));
    for (const uint32_t corner : {a, b, c}) normals.col(corner) += normal;
  }
  for (Eigen::Index k = 0; k < normals.cols(); ++k) {
    const float length = normals.col(k).norm();
    normals.col(k) = length > 0.0F ? Eigen::Vector3f(normals.col(k) / length) : Eigen::Vector3f::UnitZ();
  }
  return normals;
}

/// Turns, scales and places the skin: millimetres from `centre` to metres with y up.
Json node_of(const Eigen::Vector3d& centre, const GlbOptions& options) {
  const Eigen::Vector3d up = options.up ? Eigen::Vector3d(options.up->data()) : Eigen::Vector3d::UnitZ();
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitY());
  const Eigen::Vector3d place = kMetresPerMm * (turn * centre);
  return {{"name", "skin"},
          {"mesh", 0},
          {"translation", {place.x(), place.y(), place.z()}},
          {"rotation", {turn.x(), turn.y(), turn.z(), turn.w()}},
          {"scale", {kMetresPerMm, kMetresPerMm, kMetresPerMm}}};
}

/// The weights of all targets at every still: at each, that of the still alone.
Json animation_of(const SkinMotion& motion, const GlbOptions& options, GlbFile* file) {
  const size_t n = motion.stills.size();
  const double first = motion.stills.front().time_s;
  const double length = motion.stills.back().time_s - first;
  const double scale = options.play_s > 0.0 && length > 0.0 ? options.play_s / length : 1.0;
  std::vector<float> times, weights(n * n, 0.0F);
  for (size_t k = 0; k < n; ++k) {
    times.push_back(static_cast<float>(scale * (motion.stills[k].time_s - first)));
    weights[k * n + k] = 1.0F;
  }
  const int input = file->add_scalars(times);
  const int output = file->add_scalars(weights);
  return {{"name", "injection"},
          {"samplers", {{{"input", input}, {"interpolation", "LINEAR"}, {"output", output}}}},
          {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}};
}

}  // namespace

std::string glb_of(const SkinMotion& motion, const GlbOptions& options) {
  const Eigen::Vector3d centre = 0.5 * (motion.rest_mm.rowwise().minCoeff() + motion.rest_mm.rowwise().maxCoeff());
  const Eigen::Matrix3Xf rest = (motion.rest_mm.colwise() - centre).cast<float>();
  GlbFile file;
  Json targets = Json::array(), names = Json::array(), weights = Json::array();
  for (const SkinStill& still : motion.stills) {
    targets.push_back({{"POSITION", file.add_vectors(still.displacement_mm)}});
    names.push_back(absl::StrFormat("%.3f s", still.time_s));
    weights.push_back(targets.size() == motion.stills.size() ? 1.0 : 0.0);
  }
  Json attributes = {{"POSITION", file.add_vectors(rest)},
                     {"NORMAL", file.add_vectors(normals_of(motion, rest + motion.stills.back().displacement_mm))},
                     {"COLOR_0", file.add_colours(options.colours ? linear_colours(*options.colours)
                                                                  : colours_of(motion, options.by_pressure))}};
  Json mesh = {{"name", "skin"},
               {"primitives",
                {{{"attributes", attributes},
                  {"indices", file.add_indices(motion.triangles)},
                  {"material", 0},
                  {"targets", targets}}}},
               {"weights", weights},
               {"extras", {{"targetNames", names}}}};
  Json scene = {{"asset",
                 {{"version", "2.0"},
                  {"generator", absl::StrCat("Lipofill ", LIPOFILL_VERSION)},
                  {"extras",
                   {{"plan", options.name},
                    {"colours", options.colours       ? "scan"
                                : options.by_pressure ? "pressure_pa in bands"
                                                      : "lift_mm"},
                    {"notice", kNotAMedicalDevice}}}}},
                {"scene", 0},
                {"scenes", {{{"nodes", {0}}}}},
                {"nodes", {node_of(centre, options)}},
                {"meshes", {mesh}},
                {"materials",
                 {{{"name", "skin"},
                   {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.85}}},
                   {"doubleSided", true}}}}};
  if (motion.stills.size() > 1) scene["animations"] = Json::array({animation_of(motion, options, &file)});
  return file.bytes(std::move(scene));
}

}  // namespace lipofill::client
