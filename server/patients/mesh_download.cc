#include "server/patients/mesh_download.h"

#include <functional>
#include <utility>

#include "core/base/units.h"
#include "server/backend/scan_reading.h"
#include "server/entry/unary.h"
#include "server/wire/frame_encoding.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

std::vector<float> to_points_mm(const Eigen::Matrix3Xd& points) {
  std::vector<float> values;
  values.reserve(static_cast<size_t>(points.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(points(c, i) * kMillimetresPerMetre));
  }
  return values;
}

template <typename Visit>
void for_each_column(const geometry::LayeredGrid& grid, Visit&& visit) {
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) visit(i, j);
  }
}

simulation::MeshTopology make_skin(const geometry::LayeredGrid& grid) {
  simulation::MeshTopology mesh{"skin", to_points_mm(grid.nodes.leftCols(grid.nodes_per_level())), {}, 4};
  for_each_column(grid, [&](int i, int j) {
    for (const int node :
         {grid.node(0, i, j), grid.node(0, i + 1, j), grid.node(0, i + 1, j + 1), grid.node(0, i, j + 1)}) {
      mesh.cells.push_back(static_cast<uint32_t>(node));
    }
  });
  return mesh;
}

simulation::MeshTopology make_tissue(const geometry::LayeredGrid& grid) {
  simulation::MeshTopology mesh{"tissue", to_points_mm(grid.nodes), {}, 8};
  for (int level = 0; level + 1 < grid.n_levels(); ++level) {
    for_each_column(grid, [&](int i, int j) {
      for (const int l : {level + 1, level}) {  // the deep face first
        for (const int node :
             {grid.node(l, i, j), grid.node(l, i + 1, j), grid.node(l, i + 1, j + 1), grid.node(l, i, j + 1)}) {
          mesh.cells.push_back(static_cast<uint32_t>(node));
        }
      }
    });
  }
  return mesh;
}

simulation::MeshTopology make_scan(const geometry::SurfaceMesh& scan) {
  simulation::MeshTopology mesh{"scan", to_points_mm(scan.points), {}, 3};
  for (const auto& triangle : scan.triangles) {
    for (const int vertex : triangle) mesh.cells.push_back(static_cast<uint32_t>(vertex));
  }
  return mesh;
}

/// Writes prepared slices one after the other.
class DownloadStream : public grpc::ServerWriteReactor<v1::MeshSlice> {
 public:
  explicit DownloadStream(grpc::CallbackServerContext* context) : context_(context) {}

  void send(std::vector<v1::MeshSlice> slices) {
    slices_ = std::move(slices);
    StartWrite(&slices_[0]);
  }
  void fail(const absl::Status& status) { Finish(to_grpc_status(status)); }

  void OnWriteDone(bool ok) override {
    if (!ok) return Finish(to_grpc_status(absl::CancelledError("the client has gone")));
    if (++sent_ == slices_.size()) return Finish(grpc::Status::OK);
    if (const absl::Status known = check_still_known(context_); !known.ok()) return fail(known);
    StartWrite(&slices_[sent_]);
  }
  void OnDone() override { delete this; }

 private:
  grpc::CallbackServerContext* const context_;
  std::vector<v1::MeshSlice> slices_;
  size_t sent_ = 0;
};

using Slices = absl::StatusOr<std::vector<v1::MeshSlice>>;

std::vector<v1::MeshSlice> slice_all(std::vector<simulation::MeshTopology> meshes) {
  Topology topology;
  topology.meshes = std::move(meshes);
  std::vector<std::string> all;
  for (const auto& mesh : topology.meshes) all.push_back(mesh.name);
  return slice_meshes(to_whole_meshes(topology, all));
}

Slices slice_model(Backend& backend, const std::string& name) {
  const auto model = backend.load_model(name);
  if (!model.ok()) return model.status();
  return slice_all(make_model_meshes(**model));
}

Slices slice_scan(Backend& backend, const std::string& name) {
  const auto ids = parse_scan_name(name, "name");
  if (!ids.ok()) return ids.status();
  const auto surface = read_scan_surface(backend, ids->patient, ids->id);
  if (!surface.ok()) return surface.status();
  return slice_all({make_scan(*surface)});
}

/// Makes the slices on a thread for long calls and sends them, or says why it cannot.
grpc::ServerWriteReactor<v1::MeshSlice>* send_slices(Backend& backend, grpc::CallbackServerContext* context,
                                                     const absl::Status& valid, std::function<Slices()> make) {
  auto* stream = new DownloadStream(context);
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

std::vector<simulation::MeshTopology> make_model_meshes(const model::FaceModel& model) {
  std::vector<simulation::MeshTopology> meshes = {make_skin(model.geometry.grid)};
  if (model.geometry.scan.n_vertices() > 0) meshes.push_back(make_scan(model.geometry.scan));
  if (model.geometry.grid.n_layers() > 0) meshes.push_back(make_tissue(model.geometry.grid));
  return meshes;
}

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
