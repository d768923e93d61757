// The colours of a PLY: what is read is finite, and no more than the file holds.

#include <cmath>
#include <string>

#include "client/cpp/scene/ply_colours.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto vertices = lipofill::client::read_ply_colours(std::string(lipofill::fuzz::as_text(data, size)));
  if (!vertices.ok()) return 0;
  lipofill::fuzz::require(vertices->size() <= size, "a vertex takes at least a byte");
  for (const auto& vertex : *vertices) {
    for (const double value : vertex) lipofill::fuzz::require(std::isfinite(value), "vertices are finite");
  }
  return 0;
}
