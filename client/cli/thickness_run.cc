#include "client/cli/thickness_run.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/changed_plan.h"
#include "client/cli/picture.h"
#include "client/cpp/dicom/any_volume.h"
#include "client/cpp/errors.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/landmarks_file.h"

namespace lipofill::client {
namespace {

/// Layers lie between these: thinner hexahedra hardly hold, and deeper bone belongs elsewhere.
constexpr double kThinnestMm = 0.5;
constexpr double kDeepestLayerMm = 30.0;

/// The tissue of a label map that a layer is; none for the SMAS, which no label map has.
std::optional<Tissue> tissue_of(const v1::TissueLayer& layer) {
  const auto is = [&layer](v1::TissueLayer::Kind kind, const char* name) {
    return layer.kind() == kind || (layer.kind() == v1::TissueLayer::KIND_UNSPECIFIED && layer.name() == name);
  };
  if (is(v1::TissueLayer::SKIN, "skin")) return Tissue::kSkin;
  if (is(v1::TissueLayer::SUBCUTANEOUS, "subcutaneous")) return Tissue::kFat;
  if (is(v1::TissueLayer::MUSCLE, "muscle")) return Tissue::kMuscle;
  return std::nullopt;
}

Eigen::Matrix3Xd points_of(const Meshes& meshes, const std::string& name) {
  const Array* const points = find_array(meshes.arrays, name);
  if (points == nullptr || !points->has_points()) return {};
  const std::vector<double> values = points->to_doubles();
  return Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3, static_cast<Eigen::Index>(values.size() / 3));
}

/// Unit normals of the skin by central differences along the chart, one-sided at its border.
Eigen::Matrix3Xd inward_normals(const SkinNodes& skin) {
  const auto at = [&skin](int i, int j) {
    return skin.points_mm.col(std::clamp(j, 0, skin.n_eta - 1) * skin.n_xi + std::clamp(i, 0, skin.n_xi - 1));
  };
  Eigen::Matrix3Xd inward(3, skin.points_mm.cols());
  for (int j = 0; j < skin.n_eta; ++j) {
    for (int i = 0; i < skin.n_xi; ++i) {
      const Eigen::Vector3d xi = at(i + 1, j) - at(i - 1, j), eta = at(i, j + 1) - at(i, j - 1);
      // xi x eta points out of the face.
      inward.col(j * skin.n_xi + i) = -xi.cross(eta).normalized();
    }
  }
  return inward;
}

void put_samples(const SkinNodes& skin, const Eigen::VectorXd& thickness, v1::TissueLayer* layer) {
  v1::FieldSamples* const samples = layer->mutable_thickness_mm()->mutable_samples();
  samples->set_n_xi(static_cast<uint32_t>(skin.n_xi));
  samples->set_n_eta(static_cast<uint32_t>(skin.n_eta));
  for (const double value : thickness) {
    // Ten micrometres are below what any volume shows.
    samples->add_values(std::isfinite(value) ? std::round(100.0 * value) / 100.0 : value);
  }
  layer->clear_regional_thickness();
  layer->clear_down_to_bone();
  layer->clear_elements_through();
}

}  // namespace

ThicknessRun::ThicknessRun(Application& application, ThicknessOptions options)
    : PlanWork(application, options), options_(std::move(options)) {}

/// The volume is read before a model is built for it.
absl::Status ThicknessRun::check_input() {
  auto volume = read_any_volume(options_.volume, options_.dicom);
  if (!volume.ok()) return volume.status();
  volume_ = *std::move(volume);
  sheet_.remarks = volume_.remarks;
  if (auto status = find_labels(); !status.ok()) return status;
  return read_metal();
}

absl::Status ThicknessRun::find_labels() {
  if (volume_.label_names.empty() && options_.labels.empty()) return absl::OkStatus();
  auto labels = find_tissue_labels(options_.volume, volume_.label_names, options_.labels);
  if (!labels.ok()) return labels.status();
  labels_ = *std::move(labels);
  if (labels_.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "volume ", options_.volume, " has labels of which none is named as a tissue: say which are, as by ",
        "--labels skin=1 --labels bone=4"));
  }
  for (const auto& [label, tissue] : labels_) {
    const auto name = volume_.label_names.find(label);
    sheet_.remarks.push_back(
        absl::StrCat("label ", label, name == volume_.label_names.end() ? "" : absl::StrCat(" (", name->second, ")"),
                     " is ", name_of(tissue)));
  }
  return absl::OkStatus();
}

absl::Status ThicknessRun::read_metal() {
  if (options_.metal.empty()) {
    metal_ = find_metal(volume_, labels_, options_.measuring);
    return absl::OkStatus();
  }
  const auto ct = read_any_volume(options_.metal, {});
  if (!ct.ok()) return ct.status();
  metal_ = find_metal(*ct, {}, options_.measuring);
  return absl::OkStatus();
}

Eigen::VectorXd ThicknessRun::default_thickness(int layer) const {
  const Eigen::Index count = skin_.points_mm.cols();
  Eigen::Index outer = 0;
  const v1::ModelSpec& built = ground_.model().spec();
  for (int l = 0; l < layer; ++l) outer += built.layers(l).elements_through();
  const Eigen::Index inner = outer + built.layers(layer).elements_through();
  return (nodes_.middleCols(inner * count, count) - nodes_.middleCols(outer * count, count)).colwise().norm();
}

void ThicknessRun::take_layer(int layer, const Boundary& end, Eigen::VectorXd* above) {
  MeasuredLayer measured{spec_.layers(layer).name(), end.depth_mm - *above, end.why, 0.0, 0.0};
  const Eigen::VectorXd otherwise = default_thickness(layer);
  double known = 0.0;
  for (Eigen::Index k = 0; k < measured.thickness_mm.size(); ++k) {
    double& value = measured.thickness_mm[k];
    if (!std::isfinite(value)) {
      (*above)[k] += otherwise[k];
      continue;
    }
    known += 1.0;
    measured.thin_share += value < kThinnestMm ? 1.0 : 0.0;
    measured.deep_share += value > kDeepestLayerMm ? 1.0 : 0.0;
    value = std::clamp(value, kThinnestMm, kDeepestLayerMm);
    (*above)[k] += value;
  }
  measured.thin_share /= std::max(known, 1.0);
  measured.deep_share /= std::max(known, 1.0);
  if (known > 0.0) {
    put_samples(skin_, measured.thickness_mm, spec_.mutable_layers(layer));
    sheet_.layers.push_back(std::move(measured));
  } else {
    sheet_.untouched.push_back(measured.name);
  }
}

absl::Status ThicknessRun::measure(const Meshes& meshes) {
  spec_ = ground_.model().spec();
  skin_.n_xi = static_cast<int>(spec_.n_xi()) + 1;
  skin_.n_eta = static_cast<int>(spec_.n_eta()) + 1;
  nodes_ = points_of(meshes, "tissue.points");
  Eigen::Index levels = 1;
  for (const v1::TissueLayer& layer : spec_.layers()) levels += layer.elements_through();
  if (nodes_.cols() != levels * skin_.n_xi * skin_.n_eta)
    return absl::DataLossError("the daemon sent another number of nodes than the model has");
  skin_.points_mm = nodes_.leftCols(skin_.n_xi * skin_.n_eta);
  skin_.inward = inward_normals(skin_);
  const auto probe = ThicknessProbe::make(options_.volume, volume_, labels_, options_.measuring, metal_);
  if (!probe.ok()) return probe.status();
  Eigen::VectorXd above = Eigen::VectorXd::Zero(skin_.points_mm.cols());
  for (int l = 0; l < spec_.layers_size(); ++l) {
    progress_.show(absl::StrCat("measuring ", spec_.layers(l).name()));
    const bool is_innermost = l + 1 == spec_.layers_size();
    const auto tissue = tissue_of(spec_.layers(l));
    if (is_innermost && probe->knows(Tissue::kBone)) {
      take_layer(l, probe->find_end(skin_, Tissue::kMuscle), &above);
    } else if (tissue && probe->knows(*tissue)) {
      take_layer(l, probe->find_end(skin_, *tissue), &above);
    } else {
      above += default_thickness(l);
      sheet_.untouched.push_back(spec_.layers(l).name());
    }
  }
  if (!sheet_.layers.empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      "nothing was measured: under no node of the skin does ", options_.volume,
      labels_.empty() ? " reach the value of bone; if it is a label map say what its labels are, as by --labels bone=4"
                      : " have the tissues of the layers",
      "; plan and volume must lie in the same frame (scan extract makes the skin of a volume)"));
}

absl::Status ThicknessRun::work() {
  if (!ground_.model().spec().has_scan_region())
    return invalid_fields("thickness cannot be measured", {{"model.scan_region", "is missing: the model is a square"}});
  auto meshes = download_model_mesh(ground_.connection(), ground_.model().name());
  if (!meshes.ok()) return meshes.status();
  meshes_ = *std::move(meshes);
  if (auto status = measure(meshes_); !status.ok()) return status;
  volume_ = {};
  sheet_.up = up_of(spec_.scan_region());
  const bool has_bone_layer = std::any_of(spec_.layers().begin(), spec_.layers().end(),
                                          [](const v1::TissueLayer& layer) { return layer.has_down_to_bone(); });
  if (!has_bone_layer) ground_.plan().bone_file.reset();
  // That the layers do not fold is shown by building them.
  v1::ModelSpec spec = spec_;
  if (!has_bone_layer) spec.mutable_scan_region()->clear_bone_scan();
  auto model = ground_.build_for(std::move(spec), "measured");
  if (!model.ok()) return model.status();
  model_ = *std::move(model);
  return absl::OkStatus();
}

absl::Status ThicknessRun::write_results() const {
  const std::filesystem::path folder = options_.out;
  v1::Plan plan = plan_file_of(ground_.plan(), model_, ground_.plan().plan.simulation(), folder);
  if (!ground_.plan().bone_file) plan.clear_bone();
  if (auto status = write_text_file(folder / "plan.json", compact_message_json(plan)); !status.ok()) return status;
  if (auto status = write_thickness(sheet_, meshes_, folder); !status.ok()) return status;
  const absl::Status drawn =
      draw_picture(folder, Picture::kThickness, std::filesystem::absolute(folder / "thickness.png"));
  // Without a screen everything else is there all the same.
  return absl::IsFailedPrecondition(drawn) ? absl::OkStatus() : drawn;
}

std::string ThicknessRun::json() const {
  nlohmann::ordered_json figures = figures_of(sheet_);
  figures["plan"] = (std::filesystem::path(options_.out) / "plan.json").string();
  return figures.dump(2);
}

std::string ThicknessRun::text() const {
  return absl::StrCat(describe(sheet_), "plan.json, thickness.json, thickness.vtp and thickness.png in ", options_.out,
                      "\n");
}

}  // namespace lipofill::client
