#include "server/backend/result_reading.h"

#include <future>

#include "absl/strings/str_cat.h"
#include "server/backend/evaluation.h"
#include "server/backend/evaluation_detail.h"
#include "server/backend/parking.h"
#include "server/backend/scan_reading.h"
#include "server/store/record_names.h"
#include "server/wire/frame_encoding.h"
#include "server/wire/names.h"
#include "server/wire/report_conversion.h"
#include "server/wire/rim_width.h"

namespace lipofill::server {
namespace {

constexpr int kMaxRows = 10'000;
constexpr size_t kMaxSeriesBytes = size_t{3} << 20;

/// Takes rows in until the response is full.
class SeriesFiller {
 public:
  explicit SeriesFiller(uint64_t after_step, v1::GetSeriesResponse& response)
      : last_step_(after_step), response_(response) {}

  /// Adds rows; false when the response is full.
  bool add(v1::SeriesRow row) {
    if (row.step() <= last_step_) return true;
    const size_t bytes = row.ByteSizeLong() + 8;
    if (response_.rows_size() == kMaxRows || bytes_ + bytes > kMaxSeriesBytes) {
      response_.set_more(true);
      return false;
    }
    bytes_ += bytes;
    last_step_ = row.step();
    *response_.add_rows() = std::move(row);
    return true;
  }
  uint64_t last_step() const { return last_step_; }

 private:
  uint64_t last_step_;
  v1::GetSeriesResponse& response_;
  size_t bytes_ = 0;
};

absl::StatusOr<PresentResult> capture(Session& session, const std::vector<std::string>& meshes) {
  using Captured = std::pair<std::shared_ptr<const Topology>, std::shared_ptr<const Frame>>;
  auto answer = std::make_shared<std::promise<Captured>>();
  session.capture(meshes, [answer](std::shared_ptr<const Topology> topology, std::shared_ptr<const Frame> frame) {
    answer->set_value({std::move(topology), std::move(frame)});
  });
  const auto [topology, frame] = answer->get_future().get();
  if (topology == nullptr || frame == nullptr) {
    return absl::ResourceExhaustedError("the fields of the simulation cannot be taken");
  }
  return PresentResult{to_whole_meshes(*topology, meshes), to_whole_frame(*frame, {meshes})};
}

absl::StatusOr<PresentResult> read_result(Backend& backend, const std::string& id) {
  const auto kept = backend.store.get_result(id);
  if (!kept.ok()) return kept.status();
  PresentResult result;
  if (!result.meshes.ParseFromString(kept->meshes_message) || !result.frame.ParseFromString(kept->frame_message)) {
    return absl::DataLossError(absl::StrCat("the result of ", simulation_name(id), " cannot be read"));
  }
  return result;
}

}  // namespace

// The session first: rows that move to the store meanwhile are then seen twice, not never.
absl::Status read_series(Backend& backend, const std::string& id, uint64_t after_step,
                         v1::GetSeriesResponse& response) {
  const auto session = backend.sessions.find(id);
  const auto pending = session != nullptr ? session->pending_series(after_step) : std::vector<SeriesEntry>{};
  if (const auto record = backend.store.get_simulation(id); !record.ok()) return record.status();
  SeriesFiller filler(after_step, response);
  while (true) {
    const auto chunk = backend.store.next_series_chunk(id, filler.last_step());
    if (!chunk.ok()) return chunk.status();
    if (!chunk->has_value()) break;
    v1::GetSeriesResponse rows;
    if (!rows.ParseFromString((**chunk).rows_message)) return absl::DataLossError("the series cannot be read");
    for (v1::SeriesRow& row : *rows.mutable_rows()) {
      if (!filler.add(std::move(row))) return absl::OkStatus();
    }
  }
  for (const SeriesEntry& entry : pending) {
    if (!filler.add(to_series_row(entry))) break;
  }
  return absl::OkStatus();
}

absl::StatusOr<PresentResult> read_present(Backend& backend, const std::string& id,
                                           const std::vector<std::string>& meshes) {
  const auto session = find_or_wake(backend, id);
  if (!session.ok()) return session.status();
  return *session != nullptr ? capture(**session, meshes) : read_result(backend, id);
}

absl::StatusOr<v1::Evaluation> evaluate_simulation(Backend& backend, const v1::EvaluateSimulationRequest& request,
                                                   const Unwanted& unwanted) {
  const auto id = parse_simulation_name(request.name(), "name");
  if (!id.ok()) return id.status();
  const auto scan = parse_scan_name(request.target_scan(), "target_scan");
  if (!scan.ok()) return scan.status();
  FieldViolations violations;
  const double rim_width = read_rim_width(request, violations);
  if (!violations.empty()) return violations.to_status();
  const auto record = backend.store.get_simulation(*id);
  if (!record.ok()) return record.status();
  const auto target = read_scan_surface(backend, scan->patient, scan->id);
  if (!target.ok()) return target.status();
  if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
  const auto model = backend.load_model(record->model);
  if (!model.ok()) return model.status();
  std::vector<std::string> meshes = {"skin"};
  if (!(*model)->is_square) meshes.emplace_back("scan");
  const auto result = read_present(backend, *id, meshes);
  if (!result.ok()) return result.status();
  const auto patch = make_skin_patch(**model, result->meshes, result->frame);
  if (!patch.ok()) return patch.status();
  auto evaluation = evaluate(*patch, *target, unwanted);
  if (!evaluation.ok()) return evaluation;
  v1::SimulationSpec spec;
  spec.ParseFromString(record->spec_message);
  const PatchZones zones = find_patch_zones(**model, spec, *patch, result->frame);
  const absl::Status added = add_details(**model, *patch, zones, *target, rim_width, unwanted, *evaluation);
  if (!added.ok()) return added;
  return evaluation;
}

}  // namespace lipofill::server
