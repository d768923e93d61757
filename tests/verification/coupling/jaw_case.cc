#include "tests/verification/coupling/jaw_case.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "client/cpp/plan_file.h"
#include "core/geometry/surface_reader.h"
#include "server/wire/model_conversion.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::verification {

JawPlan load_jaw_plan() {
  return load_sample_plan("jaw_angle.json");
}

JawPlan load_sample_plan(const std::string& file, const std::filesystem::path& scan) {
  auto plan = client::load_plan(LIPOFILL_EXAMPLES "/plans/" + file);
  EXPECT_TRUE(plan.ok()) << plan.status();
  if (!plan.ok()) return {};
  if (!scan.empty()) plan->scan_file = scan.string();
  EXPECT_TRUE(client::load_plan_landmarks(&*plan).ok());
  client::take_region_from_zones(&plan->plan);
  // What the daemon would have put there: the scan and the model are passed on as they are.
  plan->plan.mutable_simulation()->set_model("patients/jaw/models/face");
  geometry::SurfaceMesh face;
  if (plan->scan_file.has_value()) {
    plan->plan.mutable_model()->mutable_scan_region()->set_scan("patients/jaw/scans/face");
    std::ifstream scan_file(*plan->scan_file, std::ios::binary);
    std::stringstream bytes;
    bytes << scan_file.rdbuf();
    const bool is_ply = std::filesystem::path(*plan->scan_file).extension() == ".ply";
    const auto format = is_ply ? geometry::SurfaceFormat::kPly : geometry::SurfaceFormat::kObj;
    auto read = geometry::read_surface(bytes.str(), format, 1e-3);
    EXPECT_TRUE(read.ok()) << read.status();
    if (!read.ok()) return {};
    face = *std::move(read);
  }
  auto model_spec = server::to_face_model_spec(plan->plan.model());
  auto spec = server::to_simulation_spec(plan->plan.simulation());
  EXPECT_TRUE(model_spec.ok() && spec.ok()) << model_spec.status() << spec.status();
  if (!model_spec.ok() || !spec.ok()) return {};
  if (plan->scan_file.has_value()) std::get<geometry::ScanRegionSpec>(model_spec->region).scan = std::move(face);
  return {*std::move(model_spec), *std::move(spec), true};
}

JawCase make_jaw_case() {
  JawPlan plan = load_jaw_plan();
  if (!plan.ok) return {};
  auto model = model::build_face_model(plan.model, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return {model.ok() ? *std::move(model) : nullptr, std::move(plan.simulation)};
}

}  // namespace lipofill::verification
