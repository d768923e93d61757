#include "core/equilibrium/tangent.h"

#include <algorithm>

#include "core/equilibrium/anderson.h"

namespace lipofill::equilibrium {
namespace {

constexpr int kMaxCorrections = 20;
/// An answer of which this is left, as a share of it, is good enough.
constexpr double kLeftShare = 2e-3;
/// Corrections that fall no faster than this tell nothing of what is left, and none are trusted to
/// fall faster than that: stiff directions come last.
constexpr double kLargestRate = 0.5;
constexpr double kLeastRate = 0.2;
/// Differences are taken over so much of the largest displacement [m].
constexpr double kDifference = 1e-7;

/// An answer that is being corrected.
class Answer {
 public:
  Answer(const LoadChange& change, const Shape& shape, const Eigen::MatrixXd& rows)
      : change_(change), values_(Eigen::VectorXd::Zero(shape.displacement.size() + shape.n_rows())) {
    question_.shape = &shape;
    question_.rows = rows;
    ask(change.force, change.volume);
  }

  bool is_open() const { return state_ == State::kOpen; }
  Question* question() { return &question_; }
  std::optional<Tangent> result() const {
    if (state_ != State::kFound) return {};
    const Eigen::Index n = question_.dx.size();
    return Tangent{values_.head(n), values_.tail(values_.size() - n)};
  }

  /// Takes what was answered to the question.
  void correct() {
    state_ = State::kLost;
    if (!question_.is_answered) return;
    const Eigen::Index n = question_.dx.size();
    Eigen::VectorXd correction(values_.size()), next;
    correction << question_.dx, question_.dp;
    mixing_.mix(values_, correction, n, next);
    values_ = next;
    const double size = values_.head(n).norm();
    if (!(size > 0.0) || !values_.allFinite()) return;
    const double step = question_.dx.norm() / size;
    const double rate = last_step_ > 0.0 ? std::max(step / last_step_, kLeastRate) : 1.0;
    last_step_ = step;
    const bool is_found = step <= kLeftShare || (rate < kLargestRate && step * rate / (1.0 - rate) <= kLeftShare);
    state_ = is_found ? State::kFound : State::kOpen;
  }

  /// Asks what is left, by a difference along the answer.
  void measure(StaticBalance& balance, const Pools& pools, const Shape& shape, const Eigen::VectorXd& springs,
               const Eigen::VectorXd& force, const Eigen::VectorXd& gap) {
    const Eigen::Index n = shape.displacement.size();
    const double h = kDifference / values_.head(n).cwiseAbs().maxCoeff();
    Shape beside = shape;
    beside.displacement += h * values_.head(n);
    beside.pressure += h * values_.tail(shape.n_rows());
    balance.bring_to(beside, springs);
    ask(change_.force + (balance.force() - force) / h, change_.volume - (shape.reduce(pools, balance.gap()) - gap) / h);
  }

 private:
  enum class State { kOpen, kFound, kLost };

  /// A pool at the suction limit keeps its pressure.
  void ask(const Eigen::VectorXd& force, const Eigen::VectorXd& volume) {
    question_.force = force;
    question_.missing = volume;
    const std::vector<char>& is_at_limit = question_.shape->is_at_limit;
    for (size_t pool = 0; pool < is_at_limit.size(); ++pool) {
      if (is_at_limit[pool] != 0) question_.missing[static_cast<Eigen::Index>(pool)] = 0.0;
    }
  }

  const LoadChange& change_;
  Eigen::VectorXd values_;  ///< dx, dp
  Question question_;
  AndersonMixing mixing_;
  State state_ = State::kOpen;
  double last_step_ = 0.0;  ///< of the last correction, share of the answer; 0: there was none
};

}  // namespace

std::vector<std::optional<Tangent>> find_tangents(StaticBalance& balance, HeldResponse& response, const Pools& pools,
                                                  const Shape& shape, const Eigen::VectorXd& springs,
                                                  const std::vector<LoadChange>& changes) {
  if (!response.has_factor()) return std::vector<std::optional<Tangent>>(changes.size());
  const Eigen::VectorXd force = balance.force();
  const Eigen::VectorXd gap = shape.reduce(pools, balance.gap());
  const Eigen::MatrixXd rows = find_rows(balance.derivative(), pools, shape);
  std::vector<Answer> answers;
  answers.reserve(changes.size());
  for (const LoadChange& change : changes) answers.emplace_back(change, shape, rows);
  for (int k = 0; k < kMaxCorrections; ++k) {
    std::vector<Question*> questions;
    for (Answer& answer : answers) {
      if (!answer.is_open()) continue;
      if (k > 0) answer.measure(balance, pools, shape, springs, force, gap);
      questions.push_back(answer.question());
    }
    if (questions.empty()) break;
    response.answer(questions);
    for (Answer& answer : answers) {
      if (answer.is_open()) answer.correct();
    }
  }
  balance.bring_to(shape, springs);
  std::vector<std::optional<Tangent>> found;
  for (const Answer& answer : answers) found.push_back(answer.result());
  return found;
}

}  // namespace lipofill::equilibrium
