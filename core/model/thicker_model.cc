#include "core/model/thicker_model.h"

#include <algorithm>

#include "core/base/hash.h"
#include "core/model/shared_parts.h"

namespace lipofill::model {

std::shared_ptr<const FaceModel> make_thicker(const FaceModel& model, int layer, double share) {
  auto thicker = std::make_shared<FaceModel>();
  geometry::LayeredGrid& grid = thicker->geometry.grid;
  grid = model.geometry.grid;
  const int top = grid.first_level(layer), bottom = grid.first_level(layer + 1);
  const int n = grid.nodes_per_level();
  const auto nodes_of = [&](int level) { return model.geometry.grid.nodes.middleCols(level * n, n); };
  for (int level = top + 1; level < grid.n_levels(); ++level) {
    grid.nodes.middleCols(level * n, n) += share * (nodes_of(std::min(level, bottom)) - nodes_of(top));
  }
  thicker->geometry.axes = model.geometry.axes;
  thicker->geometry.landmarks = model.geometry.landmarks;
  thicker->geometry.skin_area = model.geometry.skin_area;
  thicker->layers = model.layers;
  thicker->rim = model.rim;
  thicker->base = model.base;
  thicker->base_give = model.base_give;
  thicker->thickness = model.thickness;
  thicker->is_square = model.is_square;
  thicker->shared = model.shared;
  Hasher hasher;
  hasher.add("lipofill thicker model 1");
  hasher.add(model.content_hash);
  hasher.add(layer);
  hasher.add(share);
  thicker->content_hash = hasher.hex_digest();
  return thicker;
}

std::shared_ptr<const FaceModel> with_thickness(const FaceModel& model, const Eigen::VectorXd& factors) {
  std::shared_ptr<const FaceModel> result = make_thicker(model, 0, factors[0] - 1.0);
  for (Eigen::Index layer = 1; layer < factors.size(); ++layer) {
    result = make_thicker(*result, static_cast<int>(layer), factors[layer] - 1.0);
  }
  return result;
}

}  // namespace lipofill::model
