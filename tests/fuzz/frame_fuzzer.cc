// What a client makes of a stream of messages: the input is messages of lipofill.v1.WatchResponse,
// each after its length in two bytes, the lower one first.

#include "client/cpp/array_assembler.h"
#include "tests/fuzz/target.h"

namespace {

using namespace lipofill;

/// Returns false where the stream would end.
template <typename Slices>
bool add(const Slices& slices, bool is_last, client::ArrayAssembler& assembler) {
  for (const v1::ArraySlice& slice : slices) {
    if (!assembler.add(slice).ok()) return false;
  }
  if (!is_last) return true;
  const auto arrays = assembler.take();
  if (!arrays.ok()) return false;
  for (const client::Array& array : *arrays) {
    size_t elements = 1;
    for (const size_t n : array.shape) elements *= n;
    fuzz::require(array.bytes.size() == elements * client::element_size(array.type), "an array fills its shape");
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  client::ArrayAssembler meshes, frames;
  for (size_t at = 0; at + 2 <= size;) {
    const size_t length = std::min<size_t>(data[at] + 256u * data[at + 1], size - at - 2);
    v1::WatchResponse response;
    if (!response.ParseFromArray(data + at + 2, static_cast<int>(length))) return 0;
    at += 2 + length;
    if (response.has_mesh() && !add(response.mesh().arrays(), response.mesh().last(), meshes)) return 0;
    if (response.has_frame() && !add(response.frame().fields(), response.frame().last(), frames)) return 0;
  }
  return 0;
}
