#include "core/equilibrium/ensemble.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/equilibrium/anderson.h"

namespace lipofill::equilibrium {
namespace {

/// Members that go side by side: as many as share the reading of the factor.
constexpr size_t kSideBySide = 16;
/// Steps that they take together; who has not come by then goes on alone.
constexpr int kStepsTogether = 6;
/// A step that leaves more of the error than this calls for a factor, which is not made here.
constexpr double kSlowGain = 0.7;

}  // namespace

/// A member on its way.
struct Ensemble::Member {
  const MemberChange* change = nullptr;
  Parts* parts = nullptr;  ///< of its tissue
  absl::StatusOr<Settled> found;
  PoolTarget target;
  Shape shape;
  AndersonMixing mixing;
  Question question;
  double error = std::numeric_limits<double>::infinity();  ///< of forces, or of volumes
  bool is_on_its_way = false;
  int n_steps = 0;

  /// Moves as was answered.
  void step() {
    const Eigen::Index n = question.dx.size();
    Eigen::VectorXd correction(n + question.dp.size()), next;
    correction << question.dx, question.dp;
    const Eigen::VectorXd unknowns = shape.unknowns();
    mixing.mix(unknowns, correction, n, next);
    shape.move_by(next - unknowns);
    ++n_steps;
  }
};

Ensemble::Ensemble(Equilibrium& equilibrium, const PoolTarget& nominal, const Eigen::VectorXd& springs,
                   double tolerance)
    : equilibrium_(equilibrium), parts_(equilibrium.parts()), tolerance_(tolerance) {
  nominal_ = equilibrium_.find(nominal, springs, tolerance);
  held_ = equilibrium_.last();
  if (!nominal_.is_whole()) return;
  factor_at(parts_, held_);
  differentiate();
}

/// A parameter without a tangent moves nothing beforehand.
void Ensemble::differentiate() {
  std::vector<LoadChange> changes;
  for (int pool = 0; pool < parts_.pools.n(); ++pool) changes.push_back(change_by_volume(held_, pool));
  const LoadChange nothing{Eigen::VectorXd::Zero(held_.shape.displacement.size()),
                           Eigen::VectorXd::Zero(held_.shape.n_rows())};
  for (int layer = 0; layer < parts_.system.n_layers(); ++layer) {
    changes.push_back(change_by_modulus(parts_, held_, layer).value_or(nothing));
  }
  const auto tangents =
      find_tangents(parts_.balance, parts_.response, parts_.pools, held_.shape, held_.springs, changes);
  for (size_t k = 0; k < tangents.size(); ++k) {
    auto& all = k < static_cast<size_t>(parts_.pools.n()) ? by_volume_ : by_modulus_;
    all.push_back(tangents[k].value_or(Tangent{nothing.force, nothing.volume}));
  }
}

std::vector<absl::StatusOr<Settled>> Ensemble::find(const std::vector<MemberChange>& changes) {
  std::vector<absl::StatusOr<Settled>> found;
  for (size_t first = 0; first < changes.size(); first += kSideBySide) {
    std::vector<Member> members(std::min(kSideBySide, changes.size() - first));
    for (size_t k = 0; k < members.size(); ++k) begin(changes[first + k], members[k]);
    approach(members);
    for (Member& member : members) found.push_back(std::move(member.found));
  }
  return found;
}

void Ensemble::begin(const MemberChange& change, Member& member) const {
  member.change = &change;
  member.parts = change.tissue == nullptr ? &parts_ : &change.tissue->parts();
  if (!have_same_unknowns(parts_, *member.parts)) {
    member.found = absl::InvalidArgumentError("the tissue has other nodes or cells than the nominal one");
    return;
  }
  if (const absl::Status scaled = member.parts->system.scale_moduli(change.moduli); !scaled.ok()) {
    member.found = scaled;
    return;
  }
  member.is_on_its_way = true;
  member.target = held_.target;
  member.target.volume = change.volumes;
  member.shape = held_.shape;
  const auto move = [&](const Tangent& tangent, double by) {
    member.shape.displacement += by * tangent.displacement;
    member.shape.pressure += by * tangent.pressure;
  };
  const Eigen::VectorXd more = change.volumes - held_.target.volume;
  for (size_t k = 0; k < by_volume_.size(); ++k) move(by_volume_[k], more[static_cast<Eigen::Index>(k)]);
  for (size_t k = 0; k < by_modulus_.size(); ++k) {
    move(by_modulus_[k], std::log(change.moduli[static_cast<Eigen::Index>(k)]));
  }
}

/// Steps with the nominal factor, all members together, each until its forces balance or until it
/// does not come nearer, and goes on alone.
void Ensemble::approach(std::vector<Member>& members) {
  for (int step = 0;; ++step) {
    std::vector<Question*> questions;
    for (Member& member : members) {
      if (!member.is_on_its_way) continue;
      member.is_on_its_way = measure(member) && step < kStepsTogether;
      if (member.is_on_its_way) {
        questions.push_back(&member.question);
      } else {
        finish(member);
      }
    }
    if (questions.empty()) return;
    parts_.response.answer(questions);
    for (Member& member : members) {
      if (member.is_on_its_way && member.question.is_answered) member.step();
    }
  }
}

/// Asks what the member's shape lacks, where the balance then is; false where it is good, or does
/// not come nearer.
bool Ensemble::measure(Member& member) {
  Parts& parts = *member.parts;
  parts.system.scale_moduli(member.change->moduli).IgnoreError();  // they are good
  parts.balance.bring_to(member.shape, held_.springs);
  Question& question = member.question;
  question.missing = find_missing(parts.balance, parts.pools, member.target, member.shape);
  const double error = std::max(parts.balance.relative_force(),
                                relative_lack(parts.pools, member.target, member.shape, question.missing));
  const bool comes_nearer = error < kSlowGain * member.error;
  member.error = error;
  if (error <= tolerance_ || !comes_nearer || parts.balance.is_folded()) return false;
  question.shape = &member.shape;
  question.force = parts.balance.force();
  question.rows = find_rows(parts.balance.derivative(), parts.pools, member.shape);
  return true;
}

/// Makes the shape exact, where the balance is; where that fails the member is a plan of its own.
void Ensemble::finish(Member& member) {
  Parts& parts = *member.parts;
  Solver solver(parts.balance, parts_.response, parts.pools);
  const bool is_found = solver.solve(member.target, held_.springs, tolerance_, member.shape);
  Equilibrium& equilibrium = member.change->tissue == nullptr ? equilibrium_ : *member.change->tissue;
  Settled settled = is_found ? equilibrium.describe(member.target, member.shape, 1.0)
                             : equilibrium.find(member.target, held_.springs, tolerance_);
  if (is_found) settled.cost = solver.cost();
  settled.cost.iterations += member.n_steps;
  member.found = std::move(settled);
  parts.system.scale_moduli(Eigen::VectorXd::Ones(member.change->moduli.size()))
      .IgnoreError();  // the nominal ones are good
  if (solver.cost().factors > 0 || !is_found) factor_at(parts_, held_);
}

}  // namespace lipofill::equilibrium
