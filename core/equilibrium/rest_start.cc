#include "core/equilibrium/rest_start.h"

#include <Eigen/LU>
#include <utility>

#include "core/base/hash.h"

namespace lipofill::equilibrium {
namespace {

void add(Hasher& hasher, const Eigen::VectorXd& values) {
  hasher.add_bytes(values.data(), static_cast<size_t>(values.size()) * sizeof(double));
}

}  // namespace

bool RestStart::leave(const Eigen::VectorXd& volume, const Eigen::VectorXd& springs, Shape& shape, int& n_factors) {
  if (!know_rest(springs, n_factors)) return false;
  StaticBalance& balance = parts_.balance;
  shape = rest();
  balance.bring_gaps_to(shape);
  const Eigen::MatrixXd rows = find_rows(balance.derivative(), parts_.pools, shape);
  const Eigen::VectorXd missing =
      volume - shape.reduce(parts_.pools, balance.gap()) - rows.transpose() * known_->of_load;
  shape.pressure = Eigen::FullPivLU<Eigen::MatrixXd>(multiply_rows(rows, known_->of_pools)).solve(missing);
  shape.displacement = known_->of_load + known_->of_pools * shape.pressure;
  balance.bring_to(shape, springs);
  if (!(balance.relative_force() <= kFarShare)) {
    parts_.response.forget();
    return true;
  }
  return parts_.response.has_factor() || factor_at_rest(springs, n_factors);
}

bool RestStart::factor_at_rest(const Eigen::VectorXd& springs, int& n_factors) {
  ++n_factors;
  parts_.balance.bring_to(rest(), springs);
  return parts_.response.renew(parts_.balance, springs);
}

/// Takes what is known of the rest, or finds it out; the factor at rest is then at hand too.
bool RestStart::know_rest(const Eigen::VectorXd& springs, int& n_factors) {
  parts_.factor->begin();
  parts_.response.forget();
  std::string wanted = key(springs);
  if (wanted != known_key_) {
    const auto find_out = [&]() -> absl::StatusOr<std::shared_ptr<const model::RestResponse>> {
      if (!factor_at_rest(springs, n_factors)) return absl::FailedPreconditionError("not positive definite");
      auto found = std::make_shared<model::RestResponse>();
      found->of_pools = parts_.response.of_pools();
      parts_.factor->solve(parts_.balance.force(), found->of_load);
      found->is_double = parts_.factor->is_double();
      return found;
    };
    auto known = model_.shared->rest_responses.get(wanted, find_out);
    if (!known.ok()) return false;
    known_ = *std::move(known);
    known_key_ = std::move(wanted);
  }
  parts_.factor->begin(known_->is_double ? coupling::Precision::kDouble : coupling::Precision::kSingle);
  return true;
}

/// Over all that the response is made from.
std::string RestStart::key(const Eigen::VectorXd& springs) const {
  Hasher hasher;
  hasher.add(parts_.system.setup().key);
  hasher.add(parts_.system.setup().youngs_moduli);
  add(hasher, parts_.system.moduli());
  for (const std::string& gap : parts_.system.gap_keys()) hasher.add(gap);
  hasher.add(parts_.pools.of_cell);
  add(hasher, springs);
  add(hasher, load_.gravity);
  hasher.add(load_.fat_density);
  return hasher.hex_digest();
}

}  // namespace lipofill::equilibrium
