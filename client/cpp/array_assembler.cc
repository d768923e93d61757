#include "client/cpp/array_assembler.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr uint64_t kMaxArrayBytes = uint64_t{4} << 30;

/// Number of bytes that an array of this shape takes; none when that is more than any mesh needs.
std::optional<uint64_t> bytes_of(const std::vector<size_t>& shape, size_t bytes_each) {
  uint64_t bytes = bytes_each;
  for (size_t extent : shape) {
    if (extent != 0 && bytes > kMaxArrayBytes / extent) return std::nullopt;
    bytes *= extent;
  }
  return bytes;
}

absl::Status refuse(const v1::ArraySlice& slice, const std::string& what) {
  return absl::DataLossError(absl::StrCat("array '", slice.name(), "' ", what));
}

/// UINT16 codes stand for float32 values.
std::optional<ElementType> element_type_of(v1::ArrayType type) {
  switch (type) {
    case v1::FLOAT32:
    case v1::UINT16:
      return ElementType::kFloat32;
    case v1::UINT32:
      return ElementType::kUint32;
    case v1::UINT8:
      return ElementType::kUint8;
    case v1::FLOAT64:
      return ElementType::kFloat64;
    default:
      return std::nullopt;
  }
}

std::optional<ArrayLocation> location_of(v1::ArrayLocation location) {
  switch (location) {
    case v1::MESH:
      return ArrayLocation::kMesh;
    case v1::POINT:
      return ArrayLocation::kPoint;
    case v1::CELL:
      return ArrayLocation::kCell;
    default:
      return std::nullopt;
  }
}

/// True when each component has a finite range.
bool is_usable_box(const std::vector<double>& low, const std::vector<double>& high, size_t components) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  return low.size() == components && high.size() == components && std::all_of(low.begin(), low.end(), is_finite) &&
         std::all_of(high.begin(), high.end(), is_finite);
}

}  // namespace

absl::StatusOr<ArrayAssembler::Growing> ArrayAssembler::begin(const v1::ArraySlice& slice) {
  const auto type = element_type_of(slice.type());
  const auto location = location_of(slice.location());
  if (!type) return refuse(slice, absl::StrCat("has an unknown type ", slice.type()));
  if (!location) return refuse(slice, absl::StrCat("has an unknown location ", slice.location()));
  Growing growing;
  growing.array = {slice.name(), slice.unit(), *location, *type, {}, {}, slice.max_error()};
  growing.array.shape.assign(slice.shape().begin(), slice.shape().end());
  growing.is_coded = slice.type() == v1::UINT16;
  growing.box_min.assign(slice.box_min().begin(), slice.box_min().end());
  growing.box_max.assign(slice.box_max().begin(), slice.box_max().end());
  const Array& array = growing.array;
  if (array.shape.empty() || !bytes_of(array.shape, growing.bytes_each())) return refuse(slice, "has no usable shape");
  if (growing.is_coded && !is_usable_box(growing.box_min, growing.box_max, array.columns())) {
    return refuse(slice, "has codes without a usable box");
  }
  return growing;
}

/// See ArraySlice.box_min in frame_service.proto.
void ArrayAssembler::decode(Growing& coded) {
  std::vector<std::byte> codes = std::exchange(coded.array.bytes, {});
  const size_t n = codes.size() / sizeof(uint16_t);
  coded.array.bytes.resize(n * sizeof(float));
  const size_t components = coded.array.columns();
  for (size_t k = 0; k < n; ++k) {
    uint16_t code = 0;
    std::memcpy(&code, codes.data() + k * sizeof code, sizeof code);
    const double low = coded.box_min[k % components];
    const auto value = static_cast<float>(low + code / 65535.0 * (coded.box_max[k % components] - low));
    std::memcpy(coded.array.bytes.data() + k * sizeof value, &value, sizeof value);
  }
}

bool ArrayAssembler::has(const std::string& name) const {
  return std::any_of(arrays_.begin(), arrays_.end(), [&name](const Growing& g) { return g.array.name == name; });
}

absl::Status ArrayAssembler::add(const v1::ArraySlice& slice) {
  if (arrays_.empty() || arrays_.back().array.name != slice.name()) {
    if (has(slice.name())) return refuse(slice, "came twice");
    auto growing = begin(slice);
    if (!growing.ok()) return growing.status();
    arrays_.push_back(*std::move(growing));
  }
  const size_t bytes_each = arrays_.back().bytes_each();
  Array& array = arrays_.back().array;
  if (slice.offset_bytes() != array.bytes.size()) {
    return absl::DataLossError(absl::StrCat("array '", slice.name(), "': a slice at byte ", slice.offset_bytes(),
                                            " came where byte ", array.bytes.size(), " was due"));
  }
  if (array.bytes.size() + slice.data().size() > *bytes_of(array.shape, bytes_each)) {
    return refuse(slice, "is longer than its shape");
  }
  const auto* data = reinterpret_cast<const std::byte*>(slice.data().data());
  array.bytes.insert(array.bytes.end(), data, data + slice.data().size());
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Array>> ArrayAssembler::take() {
  std::vector<Array> arrays;
  for (Growing& growing : std::exchange(arrays_, {})) {
    Array& array = growing.array;
    const uint64_t expected = *bytes_of(array.shape, growing.bytes_each());
    if (array.bytes.size() != expected) {
      return absl::DataLossError(
          absl::StrCat("array '", array.name, "' ended after ", array.bytes.size(), " of ", expected, " bytes"));
    }
    if (growing.is_coded) decode(growing);
    arrays.push_back(std::move(array));
  }
  return arrays;
}

}  // namespace lipofill::client
