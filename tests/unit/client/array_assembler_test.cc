#include "client/cpp/array_assembler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A piece of a float32 point array of shape (rows, 3).
v1::ArraySlice slice(const std::string& name, uint64_t rows, uint64_t offset, const std::vector<float>& values) {
  v1::ArraySlice result;
  result.set_name(name);
  result.set_unit("mm");
  result.set_location(v1::POINT);
  result.set_type(v1::FLOAT32);
  result.add_shape(rows);
  result.add_shape(3);
  result.set_offset_bytes(offset);
  result.set_data(values.data(), values.size() * sizeof(float));
  return result;
}

TEST(ArrayAssembler, TakesPointsInDoublePrecision) {
  v1::ArraySlice points = slice("scan.points", 1, 0, {});
  points.set_type(v1::FLOAT64);
  const std::vector<double> values = {5e8 + 0.001, 2, 3};
  points.set_data(values.data(), 3 * sizeof(double));
  ArrayAssembler assembler;
  ASSERT_TRUE(assembler.add(points).ok());
  const auto arrays = assembler.take();
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_TRUE((*arrays)[0].has_points());
  EXPECT_EQ((*arrays)[0].to_doubles(), values);
}

TEST(ArrayAssembler, JoinsSlicesAndKeepsTheOrder) {
  ArrayAssembler assembler;
  ASSERT_TRUE(assembler.add(slice("film/a.b.displacement", 2, 0, {1, 2, 3, 4})).ok());
  ASSERT_TRUE(assembler.add(slice("film/a.b.displacement", 2, 16, {5, 6})).ok());
  ASSERT_TRUE(assembler.add(slice("skin.displacement", 1, 0, {7, 8, 9})).ok());
  const auto arrays = assembler.take();
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  ASSERT_EQ(arrays->size(), 2u);
  EXPECT_EQ((*arrays)[0].mesh(), "film/a.b");
  EXPECT_EQ((*arrays)[0].field(), "displacement");
  EXPECT_EQ((*arrays)[0].unit, "mm");
  EXPECT_EQ((*arrays)[0].location, ArrayLocation::kPoint);
  EXPECT_THAT((*arrays)[0].floats(), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(find_array(*arrays, "skin.displacement")->floats(), ElementsAre(7, 8, 9));
  EXPECT_EQ(find_array(*arrays, "skin.pressure"), nullptr);
  const auto empty = assembler.take();
  ASSERT_TRUE(empty.ok());
  EXPECT_TRUE(empty->empty());
}

TEST(ArrayAssembler, RefusesGapsOverrunsAndTruncation) {
  ArrayAssembler gap;
  ASSERT_TRUE(gap.add(slice("skin.displacement", 2, 0, {1, 2, 3})).ok());
  EXPECT_THAT(std::string(gap.add(slice("skin.displacement", 2, 16, {5, 6})).message()),
              HasSubstr("byte 16 came where byte 12 was due"));

  ArrayAssembler overrun;
  EXPECT_THAT(std::string(overrun.add(slice("skin.displacement", 1, 0, {1, 2, 3, 4})).message()),
              HasSubstr("longer than its shape"));

  ArrayAssembler truncated;
  ASSERT_TRUE(truncated.add(slice("skin.displacement", 2, 0, {1, 2, 3})).ok());
  EXPECT_THAT(std::string(truncated.take().status().message()), HasSubstr("ended after 12 of 24 bytes"));

  ArrayAssembler twice;
  ASSERT_TRUE(twice.add(slice("a.x", 1, 0, {1, 2, 3})).ok());
  ASSERT_TRUE(twice.add(slice("b.x", 1, 0, {1, 2, 3})).ok());
  EXPECT_THAT(std::string(twice.add(slice("a.x", 1, 0, {1, 2, 3})).message()), HasSubstr("came twice"));
}

TEST(ArrayAssembler, RefusesShapesNoMeshHas) {
  ArrayAssembler assembler;
  EXPECT_FALSE(assembler.add(slice("skin.displacement", uint64_t{1} << 62, 0, {1})).ok());
  v1::ArraySlice untyped = slice("skin.displacement", 1, 0, {1, 2, 3});
  untyped.clear_type();
  EXPECT_THAT(std::string(assembler.add(untyped).message()), HasSubstr("unknown type"));
  v1::ArraySlice shapeless = slice("skin.displacement", 1, 0, {});
  shapeless.clear_shape();
  EXPECT_THAT(std::string(assembler.add(shapeless).message()), HasSubstr("no usable shape"));
}

/// Codes of two points.
v1::ArraySlice coded_slice(const std::vector<uint16_t>& codes, uint64_t offset = 0) {
  v1::ArraySlice result = slice("skin.displacement", 2, offset, {});
  result.set_type(v1::UINT16);
  result.set_data(codes.data(), codes.size() * sizeof(uint16_t));
  for (const double low : {-1.0, 0.0, 5.0}) result.add_box_min(low);
  for (const double high : {1.0, 131070.0, 5.0}) result.add_box_max(high);
  result.set_max_error(1.5);
  return result;
}

TEST(ArrayAssembler, TurnsCodesIntoTheValuesTheyStandFor) {
  ArrayAssembler assembler;
  ASSERT_TRUE(assembler.add(coded_slice({0, 1, 0, 65535})).ok());
  ASSERT_TRUE(assembler.add(coded_slice({50000, 7}, 8)).ok());
  const auto arrays = assembler.take();
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_EQ((*arrays)[0].type, ElementType::kFloat32);
  EXPECT_THAT((*arrays)[0].floats(), ElementsAre(-1.0f, 2.0f, 5.0f, 1.0f, 100000.0f, 5.0f));
  EXPECT_EQ((*arrays)[0].max_error, 1.5);
}

TEST(ArrayAssembler, RefusesCodesWithoutABox) {
  for (const int kind : {0, 1, 2}) {
    v1::ArraySlice coded = coded_slice({0, 1, 0, 65535, 50000, 7});
    if (kind == 0) coded.clear_box_min();
    if (kind == 1) coded.mutable_box_max()->RemoveLast();
    if (kind == 2) coded.set_box_max(0, std::numeric_limits<double>::infinity());
    ArrayAssembler assembler;
    EXPECT_THAT(std::string(assembler.add(coded).message()), HasSubstr("without a usable box"));
  }
  ArrayAssembler truncated;
  ASSERT_TRUE(truncated.add(coded_slice({0, 1, 0})).ok());
  EXPECT_THAT(std::string(truncated.take().status().message()), HasSubstr("ended after 6 of 12 bytes"));
}

TEST(ArrayAssembler, ReadsWholeNumbersInPlace) {
  v1::ArraySlice cells = slice("skin.cells", 1, 0, {});
  const uint32_t indices[] = {0, 70000, 2};
  cells.set_type(v1::UINT32);
  cells.set_location(v1::MESH);
  cells.set_data(indices, sizeof indices);
  ArrayAssembler assembler;
  ASSERT_TRUE(assembler.add(cells).ok());
  const auto arrays = assembler.take();
  ASSERT_TRUE(arrays.ok());
  EXPECT_THAT((*arrays)[0].uint32s(), ElementsAre(0u, 70000u, 2u));
  EXPECT_EQ((*arrays)[0].rows(), 1u);
  EXPECT_EQ((*arrays)[0].columns(), 3u);
}

}  // namespace
}  // namespace lipofill::client
