#include "tests/bench/service/startup_bench.h"

#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cpp/frame_watcher.h"
#include "client/cpp/scan_upload.h"
#include "core/geometry/surface_reader.h"
#include "core/model/face_model.h"
#include "core/simulation/simulation.h"
#include "server/wire/frame_encoding.h"
#include "server/wire/model_conversion.h"
#include "server/wire/simulation_conversion.h"
#include "tests/bench/service/refined_scan.h"
#include "tests/bench/service/served_plan.h"

namespace lipofill::bench {
namespace {

constexpr char kFirstFrame[] = "first frame";

absl::StatusOr<geometry::SurfaceFormat> format_of(const std::filesystem::path& file) {
  const auto format = client::scan_format_of(file);
  if (!format.ok()) return format.status();
  if (*format == v1::PLY) return geometry::SurfaceFormat::kPly;
  return *format == v1::STL ? geometry::SurfaceFormat::kStl : geometry::SurfaceFormat::kObj;
}

double metres_per_unit(const client::PlanFile& plan) {
  switch (plan.plan.scan().unit()) {
    case v1::METRE:
      return 1.0;
    case v1::CENTIMETRE:
      return 1e-2;
    default:
      return 1e-3;
  }
}

absl::StatusOr<geometry::SurfaceMesh> read_scan(const client::PlanFile& plan) {
  if (!plan.scan_file) return absl::InvalidArgumentError("the plan has no scan");
  const auto format = format_of(*plan.scan_file);
  if (!format.ok()) return format.status();
  std::ifstream file(*plan.scan_file, std::ios::binary);
  std::stringstream bytes;
  bytes << file.rdbuf();
  return geometry::read_surface(bytes.str(), *format, metres_per_unit(plan));
}

/// The building tells where it is: each of its stages is a phase.
absl::StatusOr<std::shared_ptr<const model::FaceModel>> build(const model::FaceModelSpec& spec, PhaseTimes& times) {
  std::optional<std::string> stage;
  const auto end_stage = [&] {
    if (stage) times.end(*stage);
  };
  auto model = model::build_face_model(spec, [&](double, const char* next) {
    end_stage();
    stage = next;
    return true;
  });
  return model;
}

absl::StatusOr<std::shared_ptr<const model::FaceModel>> build(const client::PlanFile& plan, geometry::SurfaceMesh scan,
                                                              PhaseTimes& times) {
  v1::ModelSpec message = plan.plan.model();
  message.mutable_scan_region()->set_scan("patients/bench/scans/scan");
  auto spec = server::to_face_model_spec(message);
  if (!spec.ok()) return spec.status();
  std::get<geometry::ScanRegionSpec>(spec->region).scan = std::move(scan);
  return build(*spec, times);
}

absl::StatusOr<std::unique_ptr<simulation::Simulation>> create(const client::PlanFile& plan,
                                                               std::shared_ptr<const model::FaceModel> model) {
  v1::SimulationSpec message = plan.plan.simulation();
  message.set_model("patients/bench/models/model");
  auto spec = server::to_simulation_spec(message);
  if (!spec.ok()) return spec.status();
  return simulation::Simulation::create(std::move(model), *std::move(spec));
}

/// Meshes and fields, ready to be sent.
void encode(const simulation::Simulation& simulation) {
  server::Topology topology;
  topology.meshes = simulation.topology();
  std::vector<std::string> meshes;
  for (const auto& mesh : topology.meshes) meshes.push_back(mesh.name);
  server::Frame frame;
  frame.fields = simulation.frame(meshes);
  const auto encoded = server::encode_shared(topology, meshes);
  server::encode_shared(frame, {meshes}, encoded->topology_hash);
}

absl::Status await_first_frame(const ServedPlan& served, const std::string& id) {
  v1::WatchRequest request;
  request.set_simulation("simulations/" + id);
  for (const std::string& mesh : served.meshes()) request.add_meshes(mesh);
  client::WatchHandlers handlers;
  handlers.on_meshes = [](const client::Meshes&) { return absl::OkStatus(); };
  handlers.on_frame = [](const client::Frame&) { return absl::CancelledError("seen"); };
  const absl::Status status = client::watch(served.connection(), request, handlers);
  return absl::IsCancelled(status) ? absl::OkStatus() : status;
}

}  // namespace

double StartupTable::first_frame_ms() const {
  double sum = 0.0;
  for (const Phase& phase : phases) {
    sum += phase.wall_ms;
    if (phase.name == kFirstFrame) break;
  }
  return sum;
}

absl::StatusOr<StartupTable> measure_startup(const client::PlanFile& plan) {
  StartupTable table;
  PhaseTimes times;
  auto scan = read_scan(plan);
  if (!scan.ok()) return scan.status();
  times.end("reading the scan");
  const geometry::SurfaceCheck check = geometry::check_surface(*scan);
  times.end("checking the scan");
  if (check.components == 0) return absl::DataLossError("the scan has no part");
  table.triangles = scan->n_triangles();
  auto model = build(plan, *std::move(scan), times);
  if (!model.ok()) return model.status();
  times.end("hashing the model");
  auto simulation = create(plan, *model);
  if (!simulation.ok()) return simulation.status();
  times.end("setting up the simulation");
  encode(**simulation);
  times.end(kFirstFrame);
  (*simulation)->advance_step();
  times.end("first step");
  table.phases = times.phases();
  table.state_hash = (*simulation)->state_hash();
  return table;
}

absl::StatusOr<StartupTable> measure_served_startup(const client::PlanFile& plan) {
  StartupTable table;
  PhaseTimes times;
  const auto served = ServedPlan::start(plan, 2, [&times](const char* phase) { times.end(phase); });
  if (!served.ok()) return served.status();
  if (const absl::Status made = (*served)->create("first", plan.plan.simulation().time().step_ms() * 1e-3);
      !made.ok()) {
    return made;
  }
  times.end("setting up the simulation");
  if (const absl::Status seen = await_first_frame(**served, "first"); !seen.ok()) return seen;
  times.end(kFirstFrame);
  if (const absl::Status started = (*served)->start("first"); !started.ok()) return started;
  const auto end = (*served)->await_end("first");
  if (!end.ok()) return end.status();
  times.end("first step");
  table.triangles = (*served)->scan_triangles();
  table.phases = times.phases();
  table.state_hash = end->summary().state_hash();
  return table;
}

absl::Status write_refined_scan(const client::PlanFile& plan, int times, const std::filesystem::path& file) {
  auto scan = read_scan(plan);
  if (!scan.ok()) return scan.status();
  const auto format = format_of(file);
  if (!format.ok()) return format.status();
  for (int k = 0; k < times; ++k) scan = refine(*scan);
  std::ofstream stream(file, std::ios::binary);
  stream << write_scan(*scan, *format);
  return stream.flush() ? absl::OkStatus() : absl::UnavailableError(absl::StrCat("cannot write ", file.string()));
}

}  // namespace lipofill::bench
