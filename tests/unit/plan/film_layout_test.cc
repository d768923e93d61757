// A film on the base of the tissue, where that is not bone.

#include "core/plan/film_layout.h"

#include <gmock/gmock.h>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::plan {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Remarks on a film below a layer of the small square, on a base of this kind that gives in the
/// half where xi is at most 0.5.
std::vector<std::string> remarks_on(const std::string& below, model::SupportKind kind) {
  model::FaceModel model = *simulation::make_small_model();
  const geometry::LayeredGrid& grid = model.geometry.grid;
  model.base = {kind, 1e6};
  if (kind == model::SupportKind::kByRegion) {
    model.base_give.setZero(grid.nodes_per_level());
    for (int j = 0; j <= grid.n_eta; ++j) {
      for (int i = 0; i <= grid.n_xi / 2; ++i) model.base_give[grid.surface_index(i, j)] = 1.0;
    }
  }
  FilmSpec film = simulation::make_small_plan().films[0];
  film.below_layer = below;
  film.zones = {{"all", geometry::ChartBox{0.0, 1.0, 0.25, 0.75}}};
  const auto layout = place_film(model, film);
  EXPECT_TRUE(layout.ok()) << layout.status();
  return layout.ok() ? layout->remarks : std::vector<std::string>();
}

TEST(FilmLayout, AFilmOnABaseThatGivesIsToldToHaveBoneBeneath) {
  EXPECT_THAT(remarks_on("muscle", model::SupportKind::kByRegion),
              ElementsAre(HasSubstr("gives under 50 % of it; a film on the base has bone beneath it")));
  EXPECT_THAT(remarks_on("muscle", model::SupportKind::kElastic), ElementsAre(HasSubstr("gives under 100 % of it")));
}

TEST(FilmLayout, FilmsFurtherOutAndOnBoneNeedNoRemark) {
  for (const model::SupportKind kind : {model::SupportKind::kByRegion, model::SupportKind::kElastic}) {
    EXPECT_THAT(remarks_on("skin", kind), Not(Contains(HasSubstr("on the base"))));
  }
  EXPECT_THAT(remarks_on("muscle", model::SupportKind::kClamped), ElementsAre());
}

}  // namespace
}  // namespace lipofill::plan
