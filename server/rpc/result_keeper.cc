#include "server/rpc/result_keeper.h"

#include "lipofill/v1/simulation_service.pb.h"
#include "server/rpc/frame_encoding.h"
#include "server/rpc/report_conversion.h"

namespace lipofill::server {

absl::Status ResultKeeper::append_series(const std::string& id, const std::vector<SeriesEntry>& rows) {
  v1::GetSeriesResponse message;
  for (const SeriesEntry& row : rows) *message.add_rows() = to_series_row(row);
  return store_.append_series(id, {rows.front().report.step, rows.back().report.step, message.SerializeAsString()});
}

absl::Status ResultKeeper::ended(const std::string& id, const SessionView& view, const Topology& topology,
                                 const Frame& frame) {
  std::vector<std::string> meshes;
  for (const auto& mesh : topology.meshes) meshes.push_back(mesh.name);
  SimulationRecord record;
  record.id = id;
  record.state = view.state;
  record.reason = view.reason;
  record.summary_message = to_summary(view).SerializeAsString();
  const SimulationResult result{to_whole_meshes(topology, meshes).SerializeAsString(),
                                to_whole_frame(frame, {meshes}).SerializeAsString()};
  const absl::Status kept = store_.end_simulation(record, result);
  if (kept.ok()) sessions_.remove(id);
  return kept;
}

}  // namespace lipofill::server
