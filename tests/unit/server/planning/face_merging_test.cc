#include "server/planning/face_merging.h"

#include <gmock/gmock.h>

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A part of a face with one region below one layer.
ModelledPart make_part(const std::string& name, const std::string& region, double volume_ml,
                       const std::string& below = "subcutaneous") {
  ModelledPart part;
  part.name = name;
  v1::ScanRegion& scan = *part.model.mutable_scan_region();
  scan.set_scan("patients/anna/scans/face");
  scan.mutable_around()->add_regions(region);
  part.model.set_n_xi(40);
  part.model.set_n_eta(volume_ml > 1.0 ? 30 : 20);
  part.model.add_layers()->set_name("skin");
  part.model.mutable_layers(0)->set_elements_through(volume_ml > 1.0 ? 2 : 1);
  part.plan.set_model("patients/anna/models/" + name);
  v1::Film& film = *part.plan.add_films();
  film.set_name("film");
  film.set_below_layer(below);
  film.set_n_xi(20);
  film.add_zones()->set_name("zone");
  film.mutable_zones(0)->set_region(region);
  v1::Injection& injection = *part.plan.add_injections();
  injection.set_zone("zone");
  injection.set_volume_ml(volume_ml);
  part.plan.mutable_time()->set_end_s(30.0);
  return part;
}

std::string refusal(const std::vector<ModelledPart>& parts) {
  const auto merged = merge_parts(parts);
  EXPECT_TRUE(absl::IsFailedPrecondition(merged.status())) << merged.status();
  return std::string(merged.status().message());
}

TEST(FaceMerging, PutsZonesBelowOneLayerIntoOneFilm) {
  ModelledPart temple = make_part("temple", "temple_left", 0.5);
  const auto merged = merge_parts({make_part("cheek", "malar_left", 2.0), temple});
  ASSERT_TRUE(merged.ok()) << merged.status();
  EXPECT_EQ(merged->name, "cheek-and-temple");
  EXPECT_THAT(merged->model.scan_region().around().regions(), ElementsAre("malar_left", "temple_left"));
  EXPECT_FALSE(merged->model.has_n_xi()) << "the larger region asks for other hexahedra";
  EXPECT_FALSE(merged->model.layers(0).has_elements_through());
  ASSERT_EQ(merged->plan.films_size(), 1);
  const v1::Film& film = merged->plan.films(0);
  EXPECT_FALSE(film.has_n_xi()) << "and for other cells";
  ASSERT_EQ(film.zones_size(), 2);
  EXPECT_EQ(film.zones(0).name(), "zone");
  EXPECT_EQ(film.zones(1).name(), "zone (temple)");
  ASSERT_EQ(merged->plan.injections_size(), 2);
  EXPECT_EQ(merged->plan.injections(1).zone(), "zone (temple)");
  EXPECT_EQ(merged->plan.injections(1).volume_ml(), 0.5);
  EXPECT_EQ(merged->plan.time().end_s(), 60.0);
  EXPECT_TRUE(merged->plan.model().empty());
}

TEST(FaceMerging, KeepsFilmsBelowOtherLayersApart) {
  ModelledPart deep = make_part("deep", "malar_left", 0.5, "muscle");
  v1::Ligament& ligament = *deep.plan.add_ligaments();
  ligament.set_anatomical("zygomatic_left");
  ligament.set_film("film");
  v1::Probe& probe = *deep.plan.add_probes();
  probe.set_name("top");
  ModelledPart third = make_part("third", "temple_left", 0.25, "muscle");
  third.plan.add_ligaments()->set_anatomical("zygomatic_left");
  const auto merged = merge_parts({make_part("cheek", "malar_left", 2.0), deep, third});
  ASSERT_TRUE(merged.ok()) << merged.status();
  ASSERT_EQ(merged->plan.films_size(), 2);
  EXPECT_EQ(merged->plan.films(1).name(), "film (deep)");
  EXPECT_EQ(merged->plan.films(1).zones_size(), 2);
  ASSERT_EQ(merged->plan.ligaments_size(), 1) << "one ligament, though two parts name it";
  EXPECT_EQ(merged->plan.ligaments(0).film(), "film (deep)");
  EXPECT_EQ(merged->plan.probes(0).film(), "film (deep)") << "the first film of its own part";
  EXPECT_THAT(merged->model.scan_region().around().regions(), ElementsAre("malar_left", "temple_left"));
}

TEST(FaceMerging, RefusesWhatDiffers) {
  const ModelledPart cheek = make_part("cheek", "malar_left", 2.0);
  ModelledPart other = make_part("temple", "temple_left", 0.5);
  other.plan.mutable_fat()->set_viscosity_pa_s(30.0);
  EXPECT_THAT(refusal({cheek, other}), HasSubstr("'cheek' and 'temple' touch"));
  EXPECT_THAT(refusal({cheek, other}), HasSubstr("their plans differ in fat"));
  other = make_part("temple", "temple_left", 0.5);
  other.model.mutable_layers(0)->set_youngs_modulus_kpa(50.0);
  EXPECT_THAT(refusal({cheek, other}), HasSubstr("their models differ in layers[0].youngs_modulus_kpa: 50"));
  other = make_part("temple", "temple_left", 0.5);
  other.plan.mutable_films(0)->mutable_edge()->set_rigid(true);
  EXPECT_THAT(refusal({cheek, other}), HasSubstr("films below 'subcutaneous' differ in edge"));
}

TEST(FaceMerging, RefusesWhatIsDrawnOnAChart) {
  const ModelledPart cheek = make_part("cheek", "malar_left", 2.0);
  ModelledPart other = make_part("temple", "temple_left", 0.5);
  other.plan.mutable_films(0)->mutable_zones(0)->mutable_box()->set_xi_max(0.5);
  EXPECT_THAT(refusal({cheek, other}), HasSubstr("films[0].zones[0].box is drawn on the chart"));
  other = make_part("temple", "temple_left", 0.5);
  other.plan.mutable_injections(0)->mutable_site()->mutable_chart()->set_xi(0.5);
  EXPECT_THAT(refusal({cheek, other}), HasSubstr("injections[0].site.chart is drawn on the chart"));
  other = make_part("temple", "temple_left", 0.5);
  other.model.mutable_scan_region()->clear_around();
  EXPECT_THAT(refusal({cheek, other}), HasSubstr("corners of its own"));
}

}  // namespace
}  // namespace lipofill::server
