#include "server/wire/field_quantisation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

v1::ArraySlice make_array(const std::vector<float>& values, size_t components) {
  v1::ArraySlice array;
  array.set_type(v1::FLOAT32);
  array.add_shape(values.size() / components);
  if (components > 1) array.add_shape(components);
  array.set_data(values.data(), values.size() * sizeof(float));
  return array;
}

/// As frame_service.proto tells it, rounded to float32 in the end.
std::vector<float> decode(const v1::ArraySlice& array) {
  const int components = array.box_min_size();
  std::vector<float> values(array.data().size() / 2);
  for (size_t k = 0; k < values.size(); ++k) {
    uint16_t code = 0;
    std::memcpy(&code, array.data().data() + 2 * k, 2);
    const double low = array.box_min(static_cast<int>(k) % components);
    const double high = array.box_max(static_cast<int>(k) % components);
    values[k] = static_cast<float>(low + code / 65535.0 * (high - low));
  }
  return values;
}

TEST(FieldQuantisation, StaysWithinTheErrorItStates) {
  std::mt19937 random(7);
  for (const auto& [centre, width] :
       {std::pair(0.0, 1.0), {3e3, 1e-2}, {-5.0, 4e4}, {1e6, 1e-3}, {0.0, 1e-30}, {0.0, 3e38}}) {
    std::uniform_real_distribution<double> value(centre - width, centre + width);
    std::vector<float> values;
    for (int k = 0; k < 3 * 5000; ++k) values.push_back(static_cast<float>(value(random)));
    v1::ArraySlice array = make_array(values, 3);
    quantise(array);
    ASSERT_EQ(array.type(), v1::UINT16);
    ASSERT_EQ(array.data().size(), values.size() * 2);
    ASSERT_EQ(array.box_min_size(), 3);
    double worst = 0.0;
    const std::vector<float> decoded = decode(array);
    for (size_t k = 0; k < values.size(); ++k) {
      worst = std::max(worst, std::abs(static_cast<double>(decoded[k]) - values[k]));
    }
    EXPECT_LE(worst, array.max_error());
    // Where steps are finer than float32 itself all comes back as it was.
    const bool is_coarser_than_float = width > 0.1 * std::abs(centre);
    EXPECT_GE(worst, is_coarser_than_float ? 0.9 * array.max_error() : 0.0) << "no idle bound; width " << width;
  }
}

TEST(FieldQuantisation, EndsOfTheBoxAndConstantsAreExact) {
  v1::ArraySlice wet = make_array({0.0f, 1.0f, 1.0f, 0.0f}, 1);
  quantise(wet);
  EXPECT_THAT(decode(wet), ElementsAre(0.0f, 1.0f, 1.0f, 0.0f));
  v1::ArraySlice constant = make_array({-2.5f, -2.5f}, 1);
  quantise(constant);
  EXPECT_THAT(decode(constant), ElementsAre(-2.5f, -2.5f));
  EXPECT_LT(constant.max_error(), 1e-6);
}

TEST(FieldQuantisation, ComponentsHaveRangesOfTheirOwn) {
  v1::ArraySlice array = make_array({0.0f, 1000.0f, 1e-3f, 1001.0f}, 2);
  quantise(array);
  EXPECT_THAT(decode(array), ElementsAre(0.0f, 1000.0f, 1e-3f, 1001.0f));
  EXPECT_THAT(array.box_min(), ElementsAre(0.0, 1000.0));
}

TEST(FieldQuantisation, WhatCannotBeCodedStaysAsItIs) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    v1::ArraySlice array = make_array({1.0f, bad}, 1);
    const std::string before = array.SerializeAsString();
    quantise(array);
    EXPECT_EQ(array.SerializeAsString(), before);
  }
  v1::ArraySlice empty = make_array({}, 1);
  quantise(empty);
  EXPECT_EQ(empty.type(), v1::FLOAT32);
  v1::ArraySlice cells = make_array({1.0f}, 1);
  cells.set_type(v1::UINT32);
  quantise(cells);
  EXPECT_EQ(cells.type(), v1::UINT32);
}

}  // namespace
}  // namespace lipofill::server
