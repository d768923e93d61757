#include "core/planning/proposal.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/plan/coarse_plan.h"
#include "core/planning/proposal_candidate.h"

namespace lipofill::planning {
namespace {

/// The vertices of a scan lie this far off [m].
constexpr double kScanNoise = 0.4e-3;
/// Zones that can move the skin over less of what is missing do not reach it.
constexpr double kLeastWithinReach = 0.1;
/// Below this a remark says what the zones do not reach.
constexpr double kToldWithinReach = 0.8;
/// A zone that is foreseen to bring so many times what is worthwhile is not tried without.
constexpr double kSurelyWorth = 3.0;
/// Shares of the work, of what is reported.
constexpr double kSearchDone = 0.5;
constexpr double kCurveDone = 0.95;

absl::Status under(const char* prefix, const absl::Status& status) {
  if (field_violations_of(status).empty()) return status;
  FieldViolations violations;
  for (const FieldViolation& violation : field_violations_of(status)) {
    const bool is_own = violation.field.starts_with("bounds.");
    violations.add(is_own ? violation.field : absl::StrCat(prefix, ".", violation.field), violation.description);
  }
  return violations.to_status();
}

/// Finds a proposal, from the choices to the one that is made.
class ProposalSearch {
 public:
  ProposalSearch(const ProposalCase& face, const geometry::SurfaceMesh& target, const ProposalRequest& request,
                 const geometry::Progress& progress)
      : face_(face),
        target_(target),
        request_(request),
        bounds_(request.bounds),
        progress_(progress),
        unwanted_([this] { return !report(fraction_, stage_); }) {}

  absl::StatusOr<Proposal> run() {
    auto layouts = list_layouts();
    if (!layouts.ok()) return layouts.status();
    auto best = choose(*layouts);
    if (!best.ok()) return best.status();
    if (const absl::Status reach = check_reach(*best); !reach.ok()) return reach;
    if (const absl::Status pruned = leave_out(*best); !pruned.ok()) return pruned;
    if (const absl::Status held = make_hold(*best); !held.ok()) return held;
    return describe(*best);
  }

 private:
  bool report(double fraction, const char* stage) {
    fraction_ = fraction;
    stage_ = stage;
    return progress_ == nullptr || progress_(fraction, stage);
  }

  /// CANCELLED where the caller has had enough.
  absl::Status tell(double fraction, const char* stage) {
    return report(fraction, stage) ? absl::OkStatus() : absl::CancelledError("the proposal was cancelled");
  }

  absl::StatusOr<std::vector<ZoneLayout>> list_layouts() const {
    if (!request_.zones) return std::vector<ZoneLayout>{{"the zones of the plan", request_.plan, 0}};
    auto layouts = list_zone_layouts(*face_.model, request_.plan, face_.deficit, *request_.zones);
    if (!layouts.ok()) return layouts;
    if (!request_.plan.films.empty()) layouts->push_back({"the zones of the plan", request_.plan, 0});
    if (!layouts->empty()) return layouts;
    return absl::FailedPreconditionError(absl::StrFormat(
        "%.2f mL are missing, but nowhere more than 1 cm2 together and 6 mm away from the rim of the model; build the "
        "model of a larger region",
        face_.missing / kCubicMetresPerMillilitre));
  }

  /// The best volumes for a choice of zones, on the face or on its coarse model.
  absl::StatusOr<Candidate> try_layout(const ProposalCase& face, ZoneLayout layout) {
    plan::SimulationSpec one_each = with_one_injection_each(layout.plan);
    if (&face != &face_) one_each = plan::coarsen_plan(one_each, *face_.model, *face.model);
    auto zones = find_sought_zones(*face.model, one_each, face.deficit, request_.bounds);
    if (!zones.ok()) return under("plan", zones.status());
    auto fit = VolumeFit::create(face.model, one_each, *std::move(zones), face.points, *face.target, face.distance);
    if (!fit.ok()) return under("plan", fit.status());
    auto fitted = (*fit)->find(request_.bounds, unwanted_);
    if (!fitted.ok()) return fitted.status();
    cost_.add(fitted->cost);
    layout.plan = one_each;
    Candidate candidate{std::move(layout), *std::move(fit), *std::move(fitted), 0.0};
    const double all = face.points.area.dot(candidate.fitted.distance.cwiseAbs2());
    candidate.misfit = std::sqrt(all / face.lacking_area());
    return candidate;
  }

  /// The choices in the order in which a coarse model of the face has them come near, the one that
  /// is_better() first; those that it refuses last, as they are.
  absl::StatusOr<std::vector<size_t>> rank(const std::vector<ZoneLayout>& layouts) {
    std::vector<size_t> order(layouts.size());
    std::iota(order.begin(), order.end(), size_t{0});
    if (layouts.size() < 2) return order;
    auto coarse = make_proposal_case(plan::coarsen_model(*face_.model), target_, request_.min_deficit);
    if (!coarse.ok()) return order;
    std::vector<double> misfits(layouts.size(), kUnbounded);
    std::optional<Candidate> best;
    size_t first = 0;
    for (size_t k = 0; k < layouts.size(); ++k) {
      const double done = kSearchDone * static_cast<double>(k) / static_cast<double>(layouts.size());
      if (absl::Status wanted = tell(done, "trying zones on a coarse model"); !wanted.ok()) return wanted;
      if (best && cost_.solves() >= request_.max_solves) {
        remarks_.push_back(absl::StrFormat("%d of %d choices of zones were tried: max_solves, %d, was reached",
                                           static_cast<int>(k), static_cast<int>(layouts.size()), request_.max_solves));
        break;
      }
      auto candidate = try_layout(*coarse, layouts[k]);
      if (absl::IsCancelled(candidate.status())) return candidate.status();
      if (!candidate.ok()) continue;  // a plane that this plan cannot use, or zones that bounds forbid
      misfits[k] = candidate->misfit;
      if (best && !is_better(*candidate, *best, request_.worthwhile)) continue;
      best = *std::move(candidate);
      first = k;
    }
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      if ((a == first) != (b == first)) return best.has_value() && a == first;
      return misfits[a] < misfits[b];
    });
    return order;
  }

  /// The first choice in that order that the face itself takes.
  absl::StatusOr<Candidate> choose(const std::vector<ZoneLayout>& layouts) {
    const auto order = rank(layouts);
    if (!order.ok()) return order.status();
    absl::Status refusal = absl::InternalError("there is no choice of zones");
    bool is_first = true;
    for (const size_t k : *order) {
      if (absl::Status wanted = tell(kSearchDone, "fitting volumes"); !wanted.ok()) return wanted;
      auto candidate = try_layout(face_, layouts[k]);
      if (candidate.ok() || absl::IsCancelled(candidate.status())) return candidate;
      if (std::exchange(is_first, false)) refusal = candidate.status();
    }
    return refusal;
  }

  absl::Status check_reach(const Candidate& best) {
    const double within = share_within_reach(face_, best.fitted);
    if (within >= kToldWithinReach) return absl::OkStatus();
    const double missing = face_.missing / kCubicMetresPerMillilitre;
    const std::string what = absl::StrFormat("the zones reach the skin over %.2f of the %.2f mL that are missing",
                                             within * missing, missing);
    if (within < kLeastWithinReach) {
      return absl::FailedPreconditionError(what + "; place zones under it, or let zones be proposed");
    }
    remarks_.push_back(what);
    return absl::OkStatus();
  }

  /// Leaves out zones that bring too little, from the one with the least volume on.
  absl::Status leave_out(Candidate& best) {
    std::set<std::string> kept;
    while (best.fit->zones().size() > 1 && cost_.solves() < request_.max_solves) {
      const std::vector<SoughtZone>& zones = best.fit->zones();
      int least = -1;
      for (size_t z = 0; z < zones.size(); ++z) {
        if (kept.contains(zones[z].name) || zones[z].bounds.low > 0.0) continue;
        const auto volume = [&](int zone) { return best.fitted.volumes[zone]; };
        if (least < 0 || volume(static_cast<int>(z)) < volume(least)) least = static_cast<int>(z);
      }
      if (least < 0) break;
      if (absl::Status wanted = tell(kSearchDone, "leaving out zones that bring little"); !wanted.ok()) return wanted;
      const std::string name = zones[static_cast<size_t>(least)].name;
      kept.insert(name);
      if (foresee_without(face_, best.fitted, best.misfit, least) > best.misfit + kSurelyWorth * request_.worthwhile)
        continue;
      auto without =
          try_layout(face_, {best.layout.description, without_zone(best.layout.plan, name), best.layout.n_proposed});
      if (absl::IsCancelled(without.status())) return without.status();
      if (!without.ok() || without->misfit > best.misfit + request_.worthwhile) continue;
      remarks_.push_back(absl::StrFormat("zone '%s' is left out: with it the skin comes %.3f mm nearer", name,
                                         (without->misfit - best.misfit) * kMillimetresPerMetre));
      best = *std::move(without);
    }
    return absl::OkStatus();
  }

  /// Tightens the volumes for tissue that is not as the model has it.
  absl::Status make_hold(Candidate& best) {
    if (!request_.spread) return absl::OkStatus();
    if (absl::Status wanted = tell(kSearchDone, "trying other tissue"); !wanted.ok()) return wanted;
    auto found = make_robust(*best.fit, static_cast<int>(face_.model->layers.size()), *request_.spread, bounds_,
                             best.fitted, unwanted_, cost_);
    if (!found.ok()) return found.status();
    robustness_ = *std::move(found);
    return absl::OkStatus();
  }

  absl::StatusOr<Proposal> describe(Candidate& best) {
    Proposal proposal;
    if (robustness_) proposal.nominal_rms = face_.rms(robustness_->nominal.distance);
    proposal.robustness = std::move(robustness_);
    proposal.plan = with_volumes(best.layout.plan, best.fitted.volumes);
    std::set<std::string> own;
    for (const plan::FilmSpec& film : request_.plan.films) {
      for (const plan::ZoneSpec& zone : film.zones) own.insert(zone.name);
    }
    for (size_t z = 0; z < best.fit->zones().size(); ++z) {
      const SoughtZone& zone = best.fit->zones()[z];
      const auto k = static_cast<Eigen::Index>(z);
      proposal.volumes.push_back({zone.name, zone.below_layer, best.fitted.volumes[k], best.fitted.pressure[k],
                                  kScanNoise * best.fitted.noise_gain[k], best.fitted.bound[z],
                                  !own.contains(zone.name)});
    }
    proposal.max_lift = best.fitted.max_lift;
    proposal.state_hash = best.fitted.state_hash;
    proposal.remainders = explain_remainders(face_, best.fit->zones(), best.fitted);
    const Eigen::Matrix3Xd lifted = best.fit->shape().skin_displacement();
    auto before = face_.compare(Eigen::Matrix3Xd::Zero(3, lifted.cols()), unwanted_);
    if (!before.ok()) return before.status();
    auto reached = face_.compare(lifted, unwanted_);
    if (!reached.ok()) return reached.status();
    proposal.before = *before;
    proposal.reached = *reached;
    std::string doubt = describe_doubt(before->skin_to_target.rms, reached->skin_to_target.rms);
    if (!doubt.empty()) remarks_.push_back(std::move(doubt));
    for (const std::string& remark : best.fit->shape().shape().remarks()) remarks_.push_back(remark);
    if (absl::Status wanted = tell(kCurveDone, "tracing the curve"); !wanted.ok()) return wanted;
    auto curve = trace_trade_off(face_, *best.fit, best.fitted, bounds_, request_.curve_points, unwanted_, cost_);
    if (!curve.ok()) return curve.status();
    proposal.curve = *std::move(curve);
    for (size_t k = 0; k < proposal.curve.size(); ++k) {
      if (proposal.curve[k].volumes == best.fitted.volumes) proposal.proposed_point = k;
    }
    proposal.cost = cost_;
    proposal.remarks = std::move(remarks_);
    report(1.0, "done");
    return proposal;
  }

  const ProposalCase& face_;
  const geometry::SurfaceMesh& target_;
  const ProposalRequest& request_;
  ProposalBounds bounds_;  ///< tighter than those of the request where the plan has to hold
  const geometry::Progress& progress_;
  const Unwanted unwanted_;
  std::optional<Robustness> robustness_;
  double fraction_ = 0.0;
  const char* stage_ = "trying zones";
  ProposalCost cost_;
  std::vector<std::string> remarks_;
};

}  // namespace

double Proposal::total() const {
  double sum = 0.0;
  for (const ProposedVolume& volume : volumes) sum += volume.volume;
  return sum;
}

double Proposal::max_pressure() const {
  double most = 0.0;
  for (const ProposedVolume& volume : volumes) most = std::max(most, volume.pressure);
  return most;
}

absl::StatusOr<Proposal> propose_plan(std::shared_ptr<const model::FaceModel> model,
                                      const geometry::SurfaceMesh& target, const ProposalRequest& request,
                                      const geometry::Progress& progress) {
  if (!request.zones && request.plan.films.empty()) {
    return field_violation("plan.films", "there are none, and no zones are to be proposed");
  }
  const auto face = make_proposal_case(std::move(model), target, request.min_deficit);
  if (!face.ok()) return face.status();
  return ProposalSearch(*face, target, request, progress).run();
}

}  // namespace lipofill::planning
