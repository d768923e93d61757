// A model with one layer that is thicker: its nodes are those of a model that was built so.

#include "core/model/thicker_model.h"

#include <gtest/gtest.h>

namespace lipofill::model {
namespace {

FaceModelSpec make_spec(double skin, double muscle) {
  FaceModelSpec spec;
  spec.region = geometry::SquareSpec{0.04, 0.04};
  spec.n_xi = spec.n_eta = 4;
  spec.layers = {{"skin", {geometry::ScalarField::constant(skin), 2}, {1e5, 0.45, 1100.0}},
                 {"muscle", {geometry::ScalarField::constant(muscle), 3}, {2e5, 0.45, 1050.0}}};
  return spec;
}

TEST(ThickerModel, IsTheOneThatIsBuiltThicker) {
  const auto model = *build_face_model(make_spec(2e-3, 8e-3), nullptr);
  const auto skin = make_thicker(*model, 0, 0.1);
  EXPECT_TRUE(skin->geometry.grid.nodes.isApprox(
      (*build_face_model(make_spec(2.2e-3, 8e-3), nullptr))->geometry.grid.nodes, 1e-12));
  const auto muscle = make_thicker(*model, 1, 0.25);
  EXPECT_TRUE(muscle->geometry.grid.nodes.isApprox(
      (*build_face_model(make_spec(2e-3, 10e-3), nullptr))->geometry.grid.nodes, 1e-12));
}

TEST(ThickerModel, LeavesTheSkinAndHasAnotherName) {
  const auto model = *build_face_model(make_spec(2e-3, 8e-3), nullptr);
  const auto thicker = make_thicker(*model, 0, 0.1);
  const int n = model->geometry.grid.nodes_per_level();
  EXPECT_EQ(thicker->geometry.grid.nodes.leftCols(n), model->geometry.grid.nodes.leftCols(n));
  EXPECT_NE(thicker->content_hash, model->content_hash);
  EXPECT_NE(thicker->content_hash, make_thicker(*model, 1, 0.1)->content_hash);
  EXPECT_EQ(thicker->shared, model->shared) << "patterns are the same, and tissues have keys of their own";
}

}  // namespace
}  // namespace lipofill::model
