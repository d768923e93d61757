#include "client/cli/result_files.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/distance_fields.h"
#include "client/cli/picture.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/io/mesh_files.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/result_text.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/patient_service.grpc.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

constexpr std::chrono::seconds kEvaluationTime(600);

absl::StatusOr<std::string> target_scan(const Connection& connection, const v1::Simulation& simulation,
                                        const std::string& target, v1::ScanUnit unit) {
  if (target.starts_with("patients/") && !std::filesystem::exists(target)) return target;
  const std::string& model = simulation.spec().model();
  const auto scan = upload_scan(connection, model.substr(0, model.find("/models/")), target, unit);
  if (!scan.ok()) return scan.status();
  return scan->name();
}

/// The statistics alone: the field is in distance.vtp.
std::string statistics_json(const v1::Evaluation& evaluation) {
  auto document = nlohmann::ordered_json::parse(message_json(evaluation));
  document.erase("distance_mm");
  document.erase("vertices");
  document["points"] = evaluation.vertices_size();
  return document.dump(2) + "\n";
}

absl::Status write_distances(const std::filesystem::path& file, const FinalState& state,
                             const v1::Evaluation& evaluation) {
  auto views = mesh_views(state.meshes.arrays, state.frame.fields);
  if (!views.ok()) return views.status();
  if (views->size() != 1) return absl::DataLossError("the daemon sent other meshes than the one asked for");
  MeshView& view = views->front();
  const auto distance = distance_field(evaluation, view.points->rows());
  if (!distance.ok()) return distance.status();
  view.fields.push_back(&*distance);
  return write_mesh(file, view);
}

}  // namespace

absl::StatusOr<RunRecord> record_of_simulation(const Connection& connection, const v1::Simulation& simulation) {
  v1::GetModelRequest request;
  request.set_name(simulation.spec().model());
  const auto model = connection.call<v1::PatientService>(&v1::PatientService::Stub::GetModel, request);
  if (!model.ok() && !absl::IsNotFound(model.status())) return model.status();
  RunRecord record;
  record.plan = simulation.display_name();
  record.simulation = simulation.name();
  record.server = connection.server();
  if (model.ok()) record.up = up_of(model->spec().scan_region());
  return record;
}

absl::Status write_figures(const std::filesystem::path& folder, const std::string& plan,
                           const v1::Simulation& simulation, const std::vector<v1::SeriesRow>& rows) {
  if (auto status = write_text_file(folder / "series.csv", series_csv(simulation.spec(), rows)); !status.ok())
    return status;
  return write_text_file(folder / "summary.json", summary_json(plan, simulation));
}

absl::StatusOr<std::string> export_result(const Connection& connection, const std::string& name,
                                          const std::filesystem::path& out) {
  const auto simulation = get_simulation(connection, name);
  if (!simulation.ok()) return simulation.status();
  const auto meshes = mesh_names(connection, *simulation);
  if (!meshes.ok()) return meshes.status();
  auto state = final_state(connection, *simulation, *meshes);
  if (!state.ok()) return state.status();
  std::vector<v1::SeriesRow> rows;
  if (auto status = fetch_series(connection, simulation->name(), &rows); !status.ok()) return status;
  const auto record = record_of_simulation(connection, *simulation);
  if (!record.ok()) return record.status();

  ResultFolder folder(out);
  if (auto status = folder.prepare(); !status.ok()) return status;
  folder.set_meshes(std::move(state->meshes.arrays));
  if (auto status = folder.write_frame(state->frame.time_s, state->frame.fields); !status.ok()) return status;
  if (auto status = write_figures(folder.path(), record->plan, *simulation, rows); !status.ok()) return status;
  if (auto status = write_run_record(folder.path(), *record); !status.ok()) return status;
  return absl::StrCat("wrote the final state of ", simulation->name(), " to ", out.string());
}

absl::StatusOr<v1::Evaluation> evaluate_into(const std::filesystem::path& folder, const Connection& connection,
                                             const v1::Simulation& simulation, const std::string& target,
                                             v1::ScanUnit unit, absl::Status* picture_problem) {
  const auto scan = target_scan(connection, simulation, target, unit);
  if (!scan.ok()) return scan.status();
  v1::EvaluateSimulationRequest request;
  request.set_name(simulation.name());
  request.set_target_scan(*scan);
  auto evaluation = connection.call<v1::SimulationService>(&v1::SimulationService::Stub::EvaluateSimulation, request,
                                                           kEvaluationTime);
  if (!evaluation.ok()) return evaluation.status();
  const auto state = final_state(connection, simulation, {evaluation->mesh()});
  if (!state.ok()) return state.status();
  if (auto status = write_text_file(folder / "evaluation.json", statistics_json(*evaluation)); !status.ok())
    return status;
  if (auto status = write_distances(folder / "distance.vtp", *state, *evaluation); !status.ok()) return status;
  *picture_problem = draw_picture(folder, Picture::kDistance, folder / "distance.png");
  return evaluation;
}

}  // namespace lipofill::client
