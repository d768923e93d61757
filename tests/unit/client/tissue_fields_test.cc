// Strain and stress of tissue: a stretched, turned and squeezed block has the closed forms.

#include "client/cpp/scene/tissue_fields.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using Corners = Eigen::Matrix<double, 3, 8>;
using Eigen::Matrix3d;
using ::testing::HasSubstr;

Corners block() {
  Corners corners;
  corners << 0, 2, 2, 0, 0, 2, 2, 0, 0, 0, 3, 3, 0, 0, 3, 3, 0, 0, 0, 0, 4, 4, 4, 4;
  return corners;
}

const DeckLayer kCorotational = {.name = "", .neo_hookean = false, .shear_modulus_mpa = 0.03, .bulk_modulus_mpa = 0.2};
const DeckLayer kNeoHookean = {.name = "", .neo_hookean = true, .shear_modulus_mpa = 0.03, .bulk_modulus_mpa = 0.2};

TEST(TissueFields, ATurnIsNoStrain) {
  const Matrix3d turn = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const DeckLayer& layer : {kCorotational, kNeoHookean}) {
    const CellFields fields = compute_cell_fields(block(), turn * block(), layer);
    EXPECT_NEAR(fields.volume_ratio, 1.0, 1e-12);
    EXPECT_NEAR(fields.largest_strain, 0.0, 1e-12);
    EXPECT_NEAR(fields.von_mises_stress_kpa, 0.0, 1e-9);
    EXPECT_NEAR(fields.mean_stress_kpa, 0.0, 1e-9);
  }
}

TEST(TissueFields, AStretchHasTheClosedForms) {
  constexpr double l = 1.2;
  const Matrix3d stretch = Eigen::Vector3d(l, 1, 1).asDiagonal();
  const Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const CellFields linear = compute_cell_fields(block(), turn * stretch * block(), kCorotational);
  EXPECT_NEAR(linear.volume_ratio, l, 1e-12);
  EXPECT_NEAR(linear.largest_strain, 0.5 * (l * l - 1), 1e-12);
  EXPECT_NEAR(linear.equivalent_strain, 2.0 / 3.0 * 0.5 * (l * l - 1), 1e-12);
  // Uniaxial strain e: von Mises is 2 mu e, the mean kappa e.
  EXPECT_NEAR(linear.von_mises_stress_kpa, 1000 * 2 * 0.03 * (l - 1), 1e-9);
  EXPECT_NEAR(linear.mean_stress_kpa, 1000 * 0.2 * (l - 1), 1e-9);
  const CellFields finite = compute_cell_fields(block(), turn * stretch * block(), kNeoHookean);
  EXPECT_NEAR(finite.von_mises_stress_kpa, 1000 * 0.03 * std::pow(l, -5.0 / 3.0) * (l * l - 1), 1e-9);
  EXPECT_NEAR(finite.mean_stress_kpa, 1000 * 0.2 * (l - 1), 1e-9);
}

class DeckLayersTest : public TemporaryFolderTest {};

TEST_F(DeckLayersTest, LayersAndConstantsAreRead) {
  const auto deck = read_deck_layers(write(
      "tissue.inp",
      "** a comment\n*NODE, NSET=ALL\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D8I, ELSET=LAYER1_SKIN\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
      "*ELEMENT, TYPE=C3D8I, ELSET=LAYER2_FAT\n2, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, TYPE=SPRING1, ELSET=BASE\n9, 1\n"
      "*MATERIAL, NAME=LAYER1_SKIN\n*ELASTIC\n0.09, 0.45\n*DENSITY\n1e-9\n"
      "*MATERIAL, NAME=LAYER2_FAT\n*HYPERELASTIC, NEO HOOKE\n0.002, 10\n"));
  ASSERT_TRUE(deck.ok()) << deck.status();
  ASSERT_EQ(deck->layers.size(), 2U);
  EXPECT_THAT(deck->layer_of_cell, ::testing::ElementsAre(0, 1));
  EXPECT_NEAR(deck->layers[0].shear_modulus_mpa, 0.09 / 2.9, 1e-12);
  EXPECT_NEAR(deck->layers[0].bulk_modulus_mpa, 0.09 / 0.3, 1e-12);
  EXPECT_TRUE(deck->layers[1].neo_hookean);
  EXPECT_NEAR(deck->layers[1].shear_modulus_mpa, 0.004, 1e-12);
  EXPECT_NEAR(deck->layers[1].bulk_modulus_mpa, 0.2, 1e-12);
}

TEST_F(DeckLayersTest, OtherFilesAreRefused) {
  EXPECT_THAT(std::string(read_deck_layers(write("a.inp", "no deck")).status().message()), HasSubstr("no layers"));
  const std::string head = "*ELEMENT, TYPE=C3D8I, ELSET=LAYER1_SKIN\n";
  EXPECT_THAT(std::string(read_deck_layers(write("b.inp", head + "x, 1")).status().message()), HasSubstr("b.inp:2"));
  EXPECT_THAT(std::string(read_deck_layers(write("c.inp", head + "1,1,2,3,4,5,6,7,8\n")).status().message()),
              HasSubstr("no stiffness for LAYER1_SKIN"));
}

}  // namespace
}  // namespace lipofill::client
