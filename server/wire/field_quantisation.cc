#include "server/wire/field_quantisation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace lipofill::server {
namespace {

constexpr double kMostCode = 65535.0;
/// Relative error of rounding to float32, with a generous margin for the arithmetic in double.
constexpr double kFloatRounding = std::numeric_limits<float>::epsilon() / 2.0 * (1.0 + 1e-6);

std::vector<float> floats_of(const v1::ArraySlice& array) {
  std::vector<float> values(array.data().size() / sizeof(float));
  std::memcpy(values.data(), array.data().data(), values.size() * sizeof(float));
  return values;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void hold(double value) { low = std::min(low, value), high = std::max(high, value); }
  double code(double value) const { return high > low ? std::round((value - low) / (high - low) * kMostCode) : 0.0; }
  double max_error() const {
    return (high - low) / kMostCode / 2.0 * (1.0 + 1e-6) + kFloatRounding * std::max(std::abs(low), std::abs(high));
  }
};

std::vector<Range> find_box(const std::vector<float>& values, size_t components) {
  std::vector<Range> box(components);
  for (size_t k = 0; k < values.size(); ++k) box[k % components].hold(values[k]);
  return box;
}

}  // namespace

void quantise(v1::ArraySlice& array) {
  if (array.type() != v1::FLOAT32 || array.data().empty()) return;
  const std::vector<float> values = floats_of(array);
  if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) return;
  const size_t components = array.shape_size() > 1 ? array.shape(1) : 1;
  if (components == 0) return;
  const std::vector<Range> box = find_box(values, components);
  std::vector<uint16_t> codes(values.size());
  for (size_t k = 0; k < values.size(); ++k) codes[k] = static_cast<uint16_t>(box[k % components].code(values[k]));
  array.set_type(v1::UINT16);
  array.set_data(codes.data(), codes.size() * sizeof(uint16_t));
  double max_error = 0.0;
  for (const Range& range : box) {
    array.add_box_min(range.low);
    array.add_box_max(range.high);
    max_error = std::max(max_error, range.max_error());
  }
  array.set_max_error(max_error);
}

}  // namespace lipofill::server
