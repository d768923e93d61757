#include "server/patients/mesh_download.h"

#include <functional>
#include <utility>

#include "core/geometry/mesh_topology.h"
#include "server/backend/scan_reading.h"
#include "server/entry/prepared_stream.h"
#include "server/wire/frame_encoding.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

using Slices = absl::StatusOr<std::vector<v1::MeshSlice>>;

v1::MeshSlice gather(std::vector<geometry::MeshTopology> meshes) {
  Topology topology;
  topology.meshes = std::move(meshes);
  std::vector<std::string> all;
  for (const auto& mesh : topology.meshes) all.push_back(mesh.name);
  return to_whole_meshes(topology, all);
}

Slices slice_model(Backend& backend, const std::string& name) {
  const auto model = backend.load_model(name);
  if (!model.ok()) return model.status();
  return slice_meshes(gather(geometry::make_model_meshes((*model)->geometry)));
}

Slices slice_scan(Backend& backend, const std::string& name) {
  const auto ids = parse_scan_name(name, "name");
  if (!ids.ok()) return ids.status();
  const auto surface = read_scan_surface(backend, ids->patient, ids->id);
  if (!surface.ok()) return surface.status();
  v1::MeshSlice whole = gather({geometry::make_scan_mesh(*surface)});
  if (!surface->colours.empty()) add_colours("scan", surface->colours, whole);
  return slice_meshes(whole);
}

/// Makes the slices on a thread for long calls and sends them, or says why it cannot.
grpc::ServerWriteReactor<v1::MeshSlice>* send_slices(Backend& backend, grpc::CallbackServerContext* context,
                                                     const absl::Status& valid, std::function<Slices()> make) {
  auto* stream = new PreparedStream<v1::MeshSlice>(context);
  if (!valid.ok()) {
    stream->fail(valid);
    return stream;
  }
  const bool taken = backend.calls.run([context, stream, make = std::move(make)] {
    std::vector<v1::MeshSlice> slices;
    const absl::Status made = guarded_if_wanted(caller_has_left(context), [&]() -> absl::Status {
      auto all = make();
      if (all.ok()) slices = *std::move(all);
      return all.status();
    });
    if (made.ok()) {
      stream->send(std::move(slices));
    } else {
      stream->fail(made);
    }
  });
  if (!taken) stream->fail(too_many_calls(backend));
  return stream;
}

}  // namespace

grpc::ServerWriteReactor<v1::MeshSlice>* download_model_mesh(Backend& backend, grpc::CallbackServerContext* context,
                                                             const v1::DownloadModelMeshRequest& request) {
  absl::Status valid = check_call(context, request);
  valid.Update(parse_model_name(request.name(), "name").status());
  return send_slices(backend, context, valid, [&backend, name = request.name()] { return slice_model(backend, name); });
}

grpc::ServerWriteReactor<v1::MeshSlice>* download_scan_mesh(Backend& backend, grpc::CallbackServerContext* context,
                                                            const v1::DownloadScanMeshRequest& request) {
  absl::Status valid = check_call(context, request);
  valid.Update(parse_scan_name(request.name(), "name").status());
  return send_slices(backend, context, valid, [&backend, name = request.name()] { return slice_scan(backend, name); });
}

}  // namespace lipofill::server
