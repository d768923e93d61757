#include "client/cpp/array_assembler.h"

#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr uint64_t kMaxArrayBytes = uint64_t{4} << 30;

/// Bytes an array of this shape takes; none when that is more than any mesh needs.
std::optional<uint64_t> bytes_of(const std::vector<size_t>& shape, ElementType type) {
  uint64_t bytes = element_size(type);
  for (size_t extent : shape) {
    if (extent != 0 && bytes > kMaxArrayBytes / extent) return std::nullopt;
    bytes *= extent;
  }
  return bytes;
}

absl::StatusOr<Array> begin_array(const v1::ArraySlice& slice) {
  Array array;
  array.name = slice.name();
  array.unit = slice.unit();
  array.shape.assign(slice.shape().begin(), slice.shape().end());
  switch (slice.type()) {
    case v1::FLOAT32:
      array.type = ElementType::kFloat32;
      break;
    case v1::UINT32:
      array.type = ElementType::kUint32;
      break;
    case v1::UINT8:
      array.type = ElementType::kUint8;
      break;
    default:
      return absl::DataLossError(absl::StrCat("array '", slice.name(), "' has an unknown type ", slice.type()));
  }
  switch (slice.location()) {
    case v1::MESH:
      array.location = ArrayLocation::kMesh;
      break;
    case v1::POINT:
      array.location = ArrayLocation::kPoint;
      break;
    case v1::CELL:
      array.location = ArrayLocation::kCell;
      break;
    default:
      return absl::DataLossError(absl::StrCat("array '", slice.name(), "' has an unknown location ", slice.location()));
  }
  if (array.shape.empty() || !bytes_of(array.shape, array.type)) {
    return absl::DataLossError(absl::StrCat("array '", slice.name(), "' has no usable shape"));
  }
  return array;
}

}  // namespace

absl::Status ArrayAssembler::add(const v1::ArraySlice& slice) {
  if (arrays_.empty() || arrays_.back().name != slice.name()) {
    if (find_array(arrays_, slice.name()) != nullptr) {
      return absl::DataLossError(absl::StrCat("array '", slice.name(), "' came twice"));
    }
    auto array = begin_array(slice);
    if (!array.ok()) return array.status();
    arrays_.push_back(*std::move(array));
  }
  Array& array = arrays_.back();
  if (slice.offset_bytes() != array.bytes.size()) {
    return absl::DataLossError(absl::StrCat("array '", slice.name(), "': a slice at byte ", slice.offset_bytes(),
                                            " came where byte ", array.bytes.size(), " was due"));
  }
  if (array.bytes.size() + slice.data().size() > *bytes_of(array.shape, array.type)) {
    return absl::DataLossError(absl::StrCat("array '", slice.name(), "' is longer than its shape"));
  }
  const auto* data = reinterpret_cast<const std::byte*>(slice.data().data());
  array.bytes.insert(array.bytes.end(), data, data + slice.data().size());
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Array>> ArrayAssembler::take() {
  std::vector<Array> arrays = std::exchange(arrays_, {});
  for (const Array& array : arrays) {
    const uint64_t expected = *bytes_of(array.shape, array.type);
    if (array.bytes.size() != expected) {
      return absl::DataLossError(
          absl::StrCat("array '", array.name, "' ended after ", array.bytes.size(), " of ", expected, " bytes"));
    }
  }
  return arrays;
}

}  // namespace lipofill::client
