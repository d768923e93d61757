#include "server/planning/face_arrangement.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/plan/plan_placement.h"
#include "server/backend/size_limits.h"
#include "server/planning/face_merging.h"
#include "server/wire/names.h"
#include "server/wire/simulation_conversion.h"
#include "server/wire/violation_prefix.h"

namespace lipofill::server {
namespace {

constexpr int kMaxParts = 16;

/// Zones that come nearer to one another touch [m] (assumed): as far as that the fat of one lifts
/// the skin of the other, and a model has that much skin around its zones.
constexpr double kTouching = 12e-3;

/// A part and where it is.
struct PlacedPart {
  ModelledPart part;
  std::vector<int> skin;  ///< vertices of the scan that ride on its model, ascending
  Eigen::Matrix3Xd fat;   ///< the middle of each cell of its zones, on the skin [m]
};

absl::Status check_request(Backend& backend, const v1::ArrangeFaceRequest& request) {
  FieldViolations violations;
  violations.check_range("parts", request.parts_size(), 1, kMaxParts, "");
  std::set<std::string> names;
  std::string patient;
  for (int k = 0; k < request.parts_size(); ++k) {
    const v1::FacePart& part = request.parts(k);
    const std::string field = absl::StrCat("parts[", k, "]");
    if (!is_id(part.name())) {
      violations.add(field + ".name", absl::StrCat("is '", part.name(),
                                                   "', must be a letter and then up to 62 of a-z, "
                                                   "0-9 and -"));
    } else if (!names.insert(part.name()).second) {
      violations.add(field + ".name", absl::StrCat("is '", part.name(), "' again"));
    }
    const auto model = parse_model_name(part.plan().model(), field + ".plan.model");
    violations.absorb("", model.status());
    if (!model.ok()) continue;
    if (!patient.empty() && model->patient != patient) {
      violations.add(field + ".plan.model", "is of another patient than that of the first part");
    }
    patient = patient.empty() ? model->patient : patient;
  }
  if (!violations.empty()) return violations.to_status();
  for (const v1::FacePart& part : request.parts()) {
    if (absl::Status small = check_size(part.plan(), backend.options.sizes); !small.ok()) return small;
  }
  return absl::OkStatus();
}

/// The middle of each cell of a film, on the skin at rest.
Eigen::Matrix3Xd find_middles(const geometry::LayeredGrid& grid, const film::FilmGrid& film) {
  const Eigen::Matrix3Xd corners = plan::vertices_on_skin(grid, film);
  Eigen::Matrix3Xd middles(3, film.n_cells());
  for (int cell = 0; cell < film.n_cells(); ++cell) {
    const int slot = film.slot_of_cell[static_cast<size_t>(cell)];
    const int i = slot % film.n_xi, j = slot / film.n_xi;
    middles.col(cell) = 0.25 * (corners.col(film.vertex(i, j)) + corners.col(film.vertex(i + 1, j)) +
                                corners.col(film.vertex(i, j + 1)) + corners.col(film.vertex(i + 1, j + 1)));
  }
  return middles;
}

absl::StatusOr<PlacedPart> place_part(Backend& backend, const v1::FacePart& message) {
  PlacedPart placed;
  placed.part.name = message.name();
  placed.part.plan = message.plan();
  const auto name = parse_model_name(message.plan().model(), "");
  if (!name.ok()) return name.status();
  const auto record = backend.store.get_model(name->patient, name->id);
  if (!record.ok()) return record.status();
  placed.part.model.ParseFromString(record->spec_message);
  const auto model = backend.load_model(message.plan().model());
  if (!model.ok()) return model.status();
  const auto plan = to_simulation_spec(message.plan());
  if (!plan.ok()) return plan.status();
  plan::PlacedPlan films;
  if (const absl::Status status = plan::place_plan(**model, *plan, nullptr, films); !status.ok()) return status;
  for (const geometry::Rider& rider : (*model)->geometry.riders) placed.skin.push_back(rider.vertex);
  placed.fat.resize(3, 0);
  for (const plan::FilmLayout& film : films.films) {
    const Eigen::Matrix3Xd middles = find_middles((*model)->geometry.grid, film.grid);
    Eigen::Matrix3Xd all(3, placed.fat.cols() + middles.cols());
    all << placed.fat, middles;
    placed.fat = std::move(all);
  }
  return placed;
}

/// How near zones of the two come to one another [m].
double find_distance(const PlacedPart& one, const PlacedPart& other) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& place : one.fat.colwise()) {
    if (other.fat.cols() > 0) least = std::min(least, (other.fat.colwise() - place).colwise().norm().minCoeff());
  }
  return least;
}

/// A number a part: the first of those that it belongs to, directly or through others.
std::vector<size_t> group_touching(const std::vector<PlacedPart>& parts) {
  std::vector<size_t> group(parts.size());
  std::iota(group.begin(), group.end(), size_t{0});
  for (size_t a = 0; a < parts.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      if (find_distance(parts[a], parts[b]) > kTouching) continue;
      const size_t low = std::min(group[a], group[b]);
      const size_t high = std::max(group[a], group[b]);
      std::replace(group.begin(), group.end(), high, low);
    }
  }
  return group;
}

/// The largest of the distances over which the parts hang together, each from its nearest.
double find_widest_gap(const std::vector<const PlacedPart*>& parts) {
  double widest = 0.0;
  for (const PlacedPart* part : parts) {
    double least = std::numeric_limits<double>::infinity();
    for (const PlacedPart* other : parts) {
      if (other != part) least = std::min(least, find_distance(*part, *other));
    }
    widest = std::max(widest, least);
  }
  return widest;
}

/// Tells of parts that are simulated apart, though their models have skin in common.
void tell_of_margins(const std::vector<PlacedPart>& parts, const std::vector<size_t>& group,
                     v1::FaceArrangement& arrangement) {
  for (size_t b = 0; b < parts.size(); ++b) {
    for (size_t a = 0; a < b; ++a) {
      std::vector<int> common;
      std::set_intersection(parts[a].skin.begin(), parts[a].skin.end(), parts[b].skin.begin(), parts[b].skin.end(),
                            std::back_inserter(common));
      if (group[a] == group[b] || common.empty()) continue;
      arrangement.add_remarks(absl::StrFormat(
          "The models of '%s' and '%s' share %d vertices of the scan, and their zones are %.0f mm apart: they are "
          "simulated apart, and what each does to that skin is added up.",
          parts[a].part.name, parts[b].part.name, static_cast<int>(common.size()),
          find_distance(parts[a], parts[b]) * kMillimetresPerMetre));
    }
  }
}

absl::StatusOr<v1::ArrangedPart> arrange_group(const std::vector<const PlacedPart*>& group) {
  v1::ArrangedPart arranged;
  std::vector<ModelledPart> parts;
  for (const PlacedPart* placed : group) {
    arranged.add_of(placed->part.name);
    parts.push_back(placed->part);
  }
  if (parts.size() == 1) {
    arranged.set_name(parts[0].name);
    *arranged.mutable_plan() = parts[0].plan;
    return arranged;
  }
  auto merged = merge_parts(parts);
  if (!merged.ok()) return merged.status();
  arranged.set_name(merged->name);
  *arranged.mutable_plan() = std::move(merged->plan);
  *arranged.mutable_model_spec() = std::move(merged->model);
  arranged.set_distance_mm(find_widest_gap(group) * kMillimetresPerMetre);
  return arranged;
}

}  // namespace

absl::StatusOr<v1::FaceArrangement> arrange_face(Backend& backend, const v1::ArrangeFaceRequest& request,
                                                 const Unwanted& unwanted) {
  if (absl::Status good = check_request(backend, request); !good.ok()) return good;
  std::vector<PlacedPart> parts;
  for (int k = 0; k < request.parts_size(); ++k) {
    auto placed = place_part(backend, request.parts(k));
    if (!placed.ok()) return with_prefix(absl::StrCat("parts[", k, "].plan"), placed.status());
    if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    parts.push_back(*std::move(placed));
    const std::string& scan = parts.back().part.model.scan_region().scan();
    if (scan.empty() || scan != parts.front().part.model.scan_region().scan()) {
      return field_violation(
          absl::StrCat("parts[", k, "].plan.model"),
          scan.empty() ? "is a plate, not a part of a face" : "is of another scan than that of the first part");
    }
  }
  const std::vector<size_t> group_of = group_touching(parts);
  v1::FaceArrangement arrangement;
  for (size_t first = 0; first < parts.size(); ++first) {
    std::vector<const PlacedPart*> group;
    for (size_t k = first; k < parts.size(); ++k) {
      if (group_of[k] == first) group.push_back(&parts[k]);
    }
    if (group.empty()) continue;
    auto arranged = arrange_group(group);
    if (!arranged.ok()) return arranged.status();
    *arrangement.add_parts() = *std::move(arranged);
  }
  tell_of_margins(parts, group_of, arrangement);
  return arrangement;
}

}  // namespace lipofill::server
