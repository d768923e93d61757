// The shared patient: a synthetic atrophy on a real scan, whose goal is known, with zones proposed.

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "core/planning/proposal.h"
#include "core/simulation/simulation.h"
#include "tests/unit/anatomy/faces.h"

namespace lipofill::planning {
namespace {

struct Pair {
  std::shared_ptr<const model::FaceModel> model;
  geometry::SurfaceMesh target;
};

geometry::SurfaceMesh read_target(const std::string& file) {
  std::ifstream surface(file, std::ios::binary);
  std::stringstream text;
  text << surface.rdbuf();
  return *geometry::read_surface(text.str(), geometry::SurfaceFormat::kObj, 1e-3);
}

/// The cheek around masseter and angle, tissue by elastography, bone by region.
Pair make_pair_of(const std::string& shared) {
  geometry::ScanRegionSpec region;
  region.scan = read_target(shared + "/lps_patient_before.obj");
  std::ifstream description(shared + "/lps_patient.json");
  const nlohmann::json json = nlohmann::json::parse(description);
  for (const auto& [name, xyz] : json["landmarks_before"].items()) {
    region.landmarks[name] = 1e-3 * Eigen::Vector3d(xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>());
  }
  model::FaceModelSpec spec;
  spec.region = std::move(region);
  spec.around = model::AroundSpec{{"masseter_left", "mandibular_angle_left"}, {}, 12e-3};
  for (const auto kind : {anatomy::TissueKind::kSkin, anatomy::TissueKind::kSubcutaneous, anatomy::TissueKind::kSmas,
                          anatomy::TissueKind::kMuscle}) {
    const anatomy::TissueFigures figures = anatomy::figures_of(anatomy::TissuePreset::kElastography, kind);
    model::TissueLayerSpec layer;
    layer.name = std::string(anatomy::name_of(kind));
    layer.kind = kind;
    // The face curves too much for 10 mm of muscle.
    const double thickness = kind == anatomy::TissueKind::kMuscle ? 5e-3 : figures.thickness;
    layer.geometry = {geometry::ScalarField::constant(thickness), 0};
    layer.regional_thickness = kind == anatomy::TissueKind::kSubcutaneous;
    layer.material = {figures.youngs_modulus, figures.poisson_ratio, figures.density};
    spec.layers.push_back(layer);
  }
  spec.base.kind = model::SupportKind::kByRegion;
  spec.base.stiffness = 3e6;
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return {model.ok() ? *model : nullptr, read_target(shared + "/lps_patient_target.obj")};
}

TEST(ProposalForAPatient, BringsTheSkinNearWithZonesProposed) {
  const std::string shared = LIPOFILL_SHARED_DATA;
  if (!std::filesystem::exists(shared + "/lps_patient_before.obj")) GTEST_SKIP() << "no real scans in " << shared;
  const Pair pair = make_pair_of(shared);
  ASSERT_NE(pair.model, nullptr);
  ProposalRequest request;
  request.zones.emplace();
  request.curve_points = 3;
  const auto found = propose_plan(pair.model, pair.target, request, nullptr);
  ASSERT_TRUE(found.ok()) << found.status();
  const double before = found->before.skin_to_target.rms, reached = found->reached.skin_to_target.rms;
  std::cout << "rms " << before * 1e3 << " -> " << reached * 1e3 << " mm (" << 100.0 * reached / before << " %) over "
            << found->before.skin_vertices << " vertices, " << found->total() * 1e6 << " mL of "
            << found->before.volume.deficit * 1e6 << " mL missing, pressure " << found->max_pressure() << " Pa, lift "
            << found->max_lift * 1e3 << " mm, " << found->cost.solves() << " solves, " << found->cost.factorisations
            << " factors\n";
  for (const ProposedVolume& volume : found->volumes) {
    std::cout << "  " << volume.zone << " " << volume.volume * 1e6 << " +- " << volume.standard_error * 1e6 << " mL, "
              << volume.pressure << " Pa\n";
  }
  for (const Remainder& remainder : found->remainders) std::cout << "  " << describe_remainder(remainder) << "\n";
  for (const std::string& remark : found->remarks) std::cout << "  " << remark << "\n";
  for (const TradeOff& point : found->curve) {
    std::cout << "  " << point.total() * 1e6 << " mL, " << point.max_pressure() << " Pa, " << point.rms * 1e3
              << " mm\n";
  }
  EXPECT_LE(reached, 0.4 * before);
}

}  // namespace
}  // namespace lipofill::planning
