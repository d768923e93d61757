#include "core/forecast/member_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/units.h"
#include "core/forecast/part_bytes.h"
#include "core/forecast/sampling.h"

namespace lipofill::forecast {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using simulation::MemberResult;
using simulation::PlanChange;

/// Members of a part that is found, and kept, as a whole.
constexpr int kPart = 128;
/// Pressures change by this share where zones lie a metre off: 8.5 % for landmarks that were moved
/// by 3 mm (45 + 45 faces).
constexpr double kPressureChange = 0.085 / 3e-3;

/// This tells what the inputs make of a member.
class Members {
 public:
  Members(const model::FaceModel& model, const plan::SimulationSpec& plan, const std::vector<UncertainInput>& inputs,
          const Design& design, const Retention& retention, const std::vector<double>& months)
      : model_(model), plan_(plan), inputs_(inputs), design_(design), retention_(retention), months_(months) {}

  PlanChange change(Index member) const {
    PlanChange change{VectorXd::Ones(static_cast<Index>(model_.layers.size())),
                      VectorXd::Ones(static_cast<Index>(model_.layers.size())),
                      VectorXd::Ones(static_cast<Index>(plan_.injections.size())),
                      VectorXd::Ones(static_cast<Index>(months_.size()))};
    for (size_t k = 0; k < inputs_.size(); ++k) set(inputs_[k], design_.values(member, static_cast<Index>(k)), change);
    return change;
  }
  /// Tells how far the zones lie off [m].
  double place(Index member, Quantity along) const {
    for (size_t k = 0; k < inputs_.size(); ++k) {
      if (inputs_[k].quantity == along) return design_.values(member, static_cast<Index>(k));
    }
    return 0.0;
  }

 private:
  void set(const UncertainInput& input, double value, PlanChange& change) const {
    for (size_t layer = 0; layer < model_.layers.size(); ++layer) {
      if (model_.layers[layer].name != input.name) continue;
      if (input.quantity == Quantity::kLayerModulus) change.moduli[static_cast<Index>(layer)] = value;
      if (input.quantity == Quantity::kLayerThickness) change.thickness[static_cast<Index>(layer)] = value;
    }
    for (size_t k = 0; input.quantity == Quantity::kZoneVolume && k < plan_.injections.size(); ++k) {
      if (plan_.injections[k].zone == input.name) change.volumes[static_cast<Index>(k)] = value;
    }
    if (input.quantity != Quantity::kRetention) return;
    for (size_t time = 0; time < months_.size(); ++time) {
      change.kept[static_cast<Index>(time)] = retention_.share(months_[time], value);
    }
  }

  const model::FaceModel& model_;
  const plan::SimulationSpec& plan_;
  const std::vector<UncertainInput>& inputs_;
  const Design& design_;
  const Retention& retention_;
  const std::vector<double>& months_;
};

/// The mean length of the edges along a direction at a node.
double spacing(const geometry::LayeredGrid& grid, int i, int j, int di, int dj) {
  const auto at = [&](int k) {
    return grid.nodes.col(
        grid.surface_index(std::clamp(i + k * di, 0, grid.n_xi), std::clamp(j + k * dj, 0, grid.n_eta)));
  };
  const int steps =
      di != 0 ? std::min(i + 1, grid.n_xi) - std::max(i - 1, 0) : std::min(j + 1, grid.n_eta) - std::max(j - 1, 0);
  return (at(1) - at(-1)).norm() / steps;
}

void note_failure(const std::string& reason, int member, std::vector<MemberFailure>& failures) {
  for (MemberFailure& failure : failures) {
    if (failure.reason != reason) continue;
    ++failure.members;
    return;
  }
  failures.push_back({reason, 1, member});
}

/// Takes a member's shapes to the table, at the place of its zones.
void add_member(const Members& members, const model::FaceModel& model, int member, MemberResult result, bool fields,
                MemberTable& table) {
  if (!result.failure.empty()) return note_failure(result.failure, member, table.failures);
  const double along_xi = members.place(member, Quantity::kPlaceXi);
  const double along_eta = members.place(member, Quantity::kPlaceEta);
  const double pressure = 1.0 + kPressureChange * (along_xi + along_eta) / std::sqrt(2.0);
  const auto row = static_cast<Index>(table.settled.size());
  table.settled.push_back(member);
  for (size_t time = 0; time < result.shapes.size(); ++time) {
    simulation::MemberShape& shape = result.shapes[time];
    shape.pressure *= pressure;
    if (fields) {
      const bool is_moved = along_xi != 0.0 || along_eta != 0.0;
      const Eigen::Matrix3Xf skin =
          is_moved ? move_over_skin(model.geometry.grid, shape.skin, along_xi, along_eta) : shape.skin;
      table.skin_sum[time] += skin.cast<double>();
      table.lift[time].row(row) = skin.colwise().norm();
    }
    shape.skin.resize(3, 0);
  }
  table.shapes.push_back(std::move(result.shapes));
}

}  // namespace

Design draw_design(const std::vector<UncertainInput>& inputs, int members) {
  Design design;
  const Eigen::MatrixXd points = draw_points(members, static_cast<int>(inputs.size()));
  design.standard.resize(points.rows(), points.cols());
  design.values.resize(points.rows(), points.cols());
  for (size_t k = 0; k < inputs.size(); ++k) {
    const Distribution& distribution = inputs[k].distribution;
    design.is_gaussian.push_back(distribution.is_gaussian());
    const auto column = static_cast<Index>(k);
    for (Index row = 0; row < points.rows(); ++row) {
      const double share = points(row, column);
      design.values(row, column) = distribution.quantile(share);
      design.standard(row, column) = distribution.is_gaussian() ? normal_quantile(share) : 2.0 * share - 1.0;
    }
  }
  return design;
}

Eigen::Matrix3Xf move_over_skin(const geometry::LayeredGrid& grid, const Eigen::Matrix3Xf& field, double along_xi,
                                double along_eta) {
  Eigen::Matrix3Xf moved(3, field.cols());
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const double x = std::clamp(i - along_xi / spacing(grid, i, j, 1, 0), 0.0, static_cast<double>(grid.n_xi));
      const double y = std::clamp(j - along_eta / spacing(grid, i, j, 0, 1), 0.0, static_cast<double>(grid.n_eta));
      const int left = std::min(static_cast<int>(x), grid.n_xi - 1),
                low = std::min(static_cast<int>(y), grid.n_eta - 1);
      const auto u = static_cast<float>(x - left), v = static_cast<float>(y - low);
      const auto at = [&](int k, int l) { return field.col(grid.surface_index(left + k, low + l)); };
      moved.col(grid.surface_index(i, j)) =
          (1.0f - v) * ((1.0f - u) * at(0, 0) + u * at(1, 0)) + v * ((1.0f - u) * at(0, 1) + u * at(1, 1));
    }
  }
  return moved;
}

absl::StatusOr<MemberTable> run_members(simulation::PlanEnsemble& ensemble, const model::FaceModel& model,
                                        const plan::SimulationSpec& plan, const std::vector<UncertainInput>& inputs,
                                        const Design& design, const Retention& retention,
                                        const std::vector<double>& months, bool fields, const KeptParts& kept,
                                        const geometry::Progress& progress) {
  const Members members(model, plan, inputs, design, retention, months);
  const auto n = static_cast<int>(design.values.rows());
  const Index nodes = model.geometry.grid.nodes_per_level();
  MemberTable table;
  table.skin_sum.assign(fields ? months.size() : 0, Eigen::Matrix3Xd::Zero(3, nodes));
  table.lift.assign(fields ? months.size() : 0, Eigen::MatrixXf(n, nodes));
  for (int first = 0; first < n; first += kPart) {
    const int part = first / kPart;
    const int count = std::min(kPart, n - first);
    std::optional<std::vector<MemberResult>> results;
    if (kept.load) {
      if (const auto bytes = kept.load(part)) results = read_part(*bytes, static_cast<size_t>(count));
    }
    if (!results) {
      std::vector<PlanChange> changes;
      for (int k = 0; k < count; ++k) changes.push_back(members.change(first + k));
      auto found = ensemble.find(changes, [&](int done) {
        return !progress || progress(static_cast<double>(first + done) / n, "finding members");
      });
      if (!found.ok()) return found.status();
      if (kept.save) kept.save(part, write_part(*found));
      results = *std::move(found);
    }
    for (int k = 0; k < count; ++k) {
      add_member(members, model, first + k, std::move((*results)[static_cast<size_t>(k)]), fields, table);
    }
  }
  const auto n_settled = static_cast<Index>(table.settled.size());
  for (Eigen::MatrixXf& lift : table.lift) lift.conservativeResize(n_settled, nodes);
  return table;
}

}  // namespace lipofill::forecast
