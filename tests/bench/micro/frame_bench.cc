// What a watched step adds: its frame, and the frame's bytes on the wire.

#include <benchmark/benchmark.h>

#include "server/wire/frame_encoding.h"
#include "tests/bench/micro/micro_case.h"

namespace lipofill::bench {
namespace {

void frame(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  size_t bytes = 0;
  for (auto _ : state) {
    for (const simulation::FrameField& field : micro.simulation->frame({})) {
      bytes += field.values.size() * sizeof(float);
    }
  }
  state.SetBytesProcessed(static_cast<int64_t>(bytes));
  state.SetItemsProcessed(state.iterations());
}

void frame_encoding(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  server::Frame frame;
  frame.fields = micro.simulation->frame({});
  std::vector<std::string> meshes;
  for (const simulation::FrameField& field : frame.fields) meshes.push_back(field.mesh);
  size_t bytes = 0;
  for (auto _ : state) {
    for (const std::string& message : server::encode_frame(server::to_whole_frame(frame, {meshes})).messages) {
      bytes += message.size();
    }
  }
  state.SetBytesProcessed(static_cast<int64_t>(bytes));
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(frame)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(frame_encoding)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lipofill::bench
