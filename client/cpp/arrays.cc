#include "client/cpp/arrays.h"

#include <bit>
#include <cstdlib>

namespace lipofill::client {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are used in place, as they come over the wire");

template <typename T>
std::span<const T> view(const Array& array, ElementType type) {
  if (array.type != type) std::abort();
  return {reinterpret_cast<const T*>(array.bytes.data()), array.bytes.size() / sizeof(T)};
}

}  // namespace

size_t element_size(ElementType type) {
  switch (type) {
    case ElementType::kUint8:
      return 1;
    case ElementType::kFloat64:
      return 8;
    default:
      return 4;
  }
}

std::string_view Array::mesh() const {
  return std::string_view(name).substr(0, name.rfind('.'));
}

std::string_view Array::field() const {
  const size_t dot = name.rfind('.');
  return dot == std::string::npos ? std::string_view() : std::string_view(name).substr(dot + 1);
}

std::span<const float> Array::floats() const {
  return view<float>(*this, ElementType::kFloat32);
}
std::span<const uint32_t> Array::uint32s() const {
  return view<uint32_t>(*this, ElementType::kUint32);
}
std::span<const uint8_t> Array::uint8s() const {
  return view<uint8_t>(*this, ElementType::kUint8);
}

std::span<const double> Array::doubles() const {
  return view<double>(*this, ElementType::kFloat64);
}

std::vector<double> Array::to_doubles() const {
  if (type == ElementType::kFloat64) return {doubles().begin(), doubles().end()};
  return {floats().begin(), floats().end()};
}

const Array* find_array(std::span<const Array> arrays, std::string_view name) {
  for (const Array& array : arrays) {
    if (array.name == name) return &array;
  }
  return nullptr;
}

}  // namespace lipofill::client
