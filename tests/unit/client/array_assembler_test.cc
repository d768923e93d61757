#include "client/cpp/array_assembler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

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
