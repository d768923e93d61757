#include "client/cpp/gltf/gltf_accessor.h"

#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 0;
}

size_t bytes_of(int component_type) {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

template <typename Value>
double number_at(const char* at, bool normalised) {
  Value value;
  std::memcpy(&value, at, sizeof value);
  if constexpr (std::is_integral_v<Value>) {
    if (normalised) {
      const double scaled = static_cast<double>(value) / static_cast<double>(std::numeric_limits<Value>::max());
      return scaled < -1.0 ? -1.0 : scaled;
    }
  }
  return static_cast<double>(value);
}

double read_number(const char* at, int component_type, bool normalised) {
  switch (component_type) {
    case 5120:
      return number_at<int8_t>(at, normalised);
    case 5121:
      return number_at<uint8_t>(at, normalised);
    case 5122:
      return number_at<int16_t>(at, normalised);
    case 5123:
      return number_at<uint16_t>(at, normalised);
    case 5125:
      return number_at<uint32_t>(at, normalised);
    default:
      return number_at<float>(at, normalised);
  }
}

/// The place is where the elements of an accessor lie, checked.
struct Place {
  const std::string* buffer = nullptr;
  size_t begin = 0;
  size_t stride = 0;
};

absl::StatusOr<Place> place_of(const GltfDocument& document, const nlohmann::json& accessor, size_t count,
                               size_t element_bytes) {
  const auto& views = document.json.at("bufferViews");
  const auto index = accessor.at("bufferView").get<uint64_t>();
  if (index >= views.size())
    return absl::InvalidArgumentError(absl::StrCat("names buffer view ", index, " of ", views.size()));
  const nlohmann::json& view = views[static_cast<size_t>(index)];
  const auto buffer = view.at("buffer").get<uint64_t>();
  if (buffer >= document.buffers.size())
    return absl::InvalidArgumentError(absl::StrCat("names buffer ", buffer, " of ", document.buffers.size()));
  const auto view_begin = view.value("byteOffset", uint64_t{0});
  const auto view_bytes = view.at("byteLength").get<uint64_t>();
  const auto offset = accessor.value("byteOffset", uint64_t{0});
  const auto stride = view.value("byteStride", static_cast<uint64_t>(element_bytes));
  const uint64_t there = document.buffers[static_cast<size_t>(buffer)].size();
  if (view_begin > there || view_bytes > there - view_begin)
    return absl::InvalidArgumentError(absl::StrCat("reaches beyond its buffer of ", there, " bytes"));
  // 252 bytes are the most that the format allows between elements.
  if (stride < element_bytes || stride > 252)
    return absl::InvalidArgumentError(absl::StrCat("has a byteStride of ", stride));
  const uint64_t needed = count == 0 ? 0 : (count - 1) * stride + element_bytes;
  if (offset > view_bytes || needed > view_bytes - offset)
    return absl::InvalidArgumentError(absl::StrCat("reaches beyond its buffer view of ", view_bytes, " bytes"));
  return Place{&document.buffers[static_cast<size_t>(buffer)], static_cast<size_t>(view_begin + offset),
               static_cast<size_t>(stride)};
}

}  // namespace

absl::StatusOr<GltfNumbers> read_gltf_accessor(const GltfDocument& document, size_t accessor, absl::string_view what) {
  const auto wrong = [&what](absl::string_view message) {
    return absl::InvalidArgumentError(absl::StrCat("has an accessor for ", what, " that ", message));
  };
  const auto& accessors = document.json.at("accessors");
  if (accessor >= accessors.size()) return wrong(absl::StrCat("is number ", accessor, " of ", accessors.size()));
  const nlohmann::json& found = accessors[accessor];
  if (found.contains("sparse") || !found.contains("bufferView"))
    return wrong("is sparse, which is not read; export it as plain arrays");
  const auto type = found.at("type").get<std::string>();
  const auto component_type = found.at("componentType").get<int>();
  const auto count = found.at("count").get<uint64_t>();
  GltfNumbers numbers;
  numbers.components = components_of(type);
  const size_t bytes = bytes_of(component_type);
  if (numbers.components == 0 || bytes == 0)
    return wrong(absl::StrCat("is of type ", type, " and component type ", component_type));
  if (count > kMaxGltfElements)
    return wrong(absl::StrCat("has ", count, " elements, more than the ", kMaxGltfElements, " allowed"));
  const auto place = place_of(document, found, static_cast<size_t>(count), numbers.components * bytes);
  if (!place.ok()) return wrong(place.status().message());
  const bool normalised = found.value("normalized", false);
  numbers.values.reserve(static_cast<size_t>(count) * numbers.components);
  for (size_t k = 0; k < count; ++k) {
    const char* const element = place->buffer->data() + place->begin + k * place->stride;
    for (size_t c = 0; c < numbers.components; ++c)
      numbers.values.push_back(read_number(element + c * bytes, component_type, normalised));
  }
  return numbers;
}

}  // namespace lipofill::client
