// From a scan's bytes to a model: readers, cutting and charting, layers.

#include <benchmark/benchmark.h>

#include <cstring>

#include "absl/strings/str_format.h"
#include "core/geometry/scan_region.h"
#include "core/geometry/surface_chart.h"
#include "core/geometry/surface_reader.h"
#include "core/model/face_model.h"
#include "tests/bench/jaw_angle.h"

namespace lipofill::bench {
namespace {

using geometry::SurfaceFormat;
using geometry::SurfaceMesh;

const SampleFace& sample_face() {
  static const absl::StatusOr<SampleFace> face = load_sample_face(1);
  return face.value();
}

const SurfaceMesh& scan() {
  return std::get<geometry::ScanRegionSpec>(sample_face().model.region).scan;
}

std::string as_obj() {
  std::string text;
  for (const auto x : scan().points.colwise()) absl::StrAppendFormat(&text, "v %.6f %.6f %.6f\n", x[0], x[1], x[2]);
  for (const auto& t : scan().triangles) absl::StrAppendFormat(&text, "f %d %d %d\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

template <typename T>
void append_number(std::string& bytes, T number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string as_binary_ply() {
  std::string bytes = absl::StrFormat(
      "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
      "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
      scan().n_vertices(), scan().triangles.size());
  for (const double coordinate : scan().points.reshaped()) append_number(bytes, static_cast<float>(coordinate));
  for (const auto& triangle : scan().triangles) {
    append_number(bytes, uint8_t{3});
    for (const int v : triangle) append_number(bytes, v);
  }
  return bytes;
}

std::string as_binary_stl() {
  constexpr size_t kHeaderSize = 80;
  std::string bytes(kHeaderSize, ' ');
  append_number(bytes, static_cast<uint32_t>(scan().triangles.size()));
  for (const auto& triangle : scan().triangles) {
    bytes.append(3 * sizeof(float), '\0');
    for (const int v : triangle) {
      for (const double coordinate : scan().points.col(v)) append_number(bytes, static_cast<float>(coordinate));
    }
    append_number(bytes, uint16_t{0});
  }
  return bytes;
}

void read(benchmark::State& state, const std::string& bytes, SurfaceFormat format) {
  for (auto _ : state) {
    const auto mesh = geometry::read_surface(bytes, format, 1.0);
    if (!mesh.ok()) state.SkipWithError(std::string(mesh.status().message()).c_str());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(bytes.size()));
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(scan().triangles.size()));
}

void read_obj(benchmark::State& state) {
  read(state, as_obj(), SurfaceFormat::kObj);
}
void read_ply(benchmark::State& state) {
  read(state, as_binary_ply(), SurfaceFormat::kPly);
}
void read_stl(benchmark::State& state) {
  read(state, as_binary_stl(), SurfaceFormat::kStl);
}

/// Cleans the scan and cuts the region out of its outer skin.
void cut_region(benchmark::State& state) {
  const auto& region = std::get<geometry::ScanRegionSpec>(sample_face().model.region);
  for (auto _ : state) benchmark::DoNotOptimize(geometry::find_scan_region(region, nullptr).ok());
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(scan().triangles.size()));
}

/// Maps the patch to a rectangle and resamples it.
void chart(benchmark::State& state) {
  const auto face = load_sample_face(static_cast<int>(state.range(0)));
  const auto& model = face->model;
  const auto region = geometry::find_scan_region(std::get<geometry::ScanRegionSpec>(model.region), nullptr);
  for (auto _ : state) {
    benchmark::DoNotOptimize(geometry::chart_region(region->patch, model.n_xi, model.n_eta).ok());
  }
  state.SetItemsProcessed(state.iterations() * model.n_xi * model.n_eta);
}

/// All of it, layers included.
void build_model(benchmark::State& state) {
  const auto face = load_sample_face(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(model::build_face_model(face->model, nullptr).ok());
  state.SetItemsProcessed(state.iterations() * face->model.n_xi * face->model.n_eta);
}

BENCHMARK(read_obj)->Unit(benchmark::kMillisecond);
BENCHMARK(read_ply)->Unit(benchmark::kMillisecond);
BENCHMARK(read_stl)->Unit(benchmark::kMillisecond);
BENCHMARK(cut_region)->Unit(benchmark::kMillisecond);
BENCHMARK(chart)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(build_model)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lipofill::bench
