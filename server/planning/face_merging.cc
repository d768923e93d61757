#include "server/planning/face_merging.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace lipofill::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::util::MessageDifferencer;

/// A plan that does not say when it ends lasts this long [s].
constexpr double kDefaultEnd = 60.0;
/// An id has at most so many letters.
constexpr size_t kMaxName = 63;

/// The path of the first thing that is drawn on a chart.
std::optional<std::string> find_on_chart(const Message& message, const std::string& path) {
  static const std::set<std::string> kOnChart = {"lipofill.v1.ChartPoint", "lipofill.v1.ChartBox",
                                                 "lipofill.v1.FieldSamples"};
  if (kOnChart.contains(std::string(message.GetDescriptor()->full_name()))) return path;
  const auto& access = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  access.ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE || field->is_map()) continue;
    const std::string name = absl::StrCat(path, path.empty() ? "" : ".", field->name());
    if (!field->is_repeated()) {
      if (auto found = find_on_chart(access.GetMessage(message, field), name)) return found;
      continue;
    }
    for (int k = 0; k < access.FieldSize(message, field); ++k) {
      auto found = find_on_chart(access.GetRepeatedMessage(message, field, k), absl::StrCat(name, "[", k, "]"));
      if (found) return found;
    }
  }
  return std::nullopt;
}

/// Tells what differs first, as "fat.viscosity_pa_s: 15 -> 20"; empty where nothing does.
std::string find_difference(const Message& one, const Message& other) {
  std::string report;
  MessageDifferencer differencer;
  differencer.ReportDifferencesToString(&report);
  if (differencer.Compare(one, other)) return "";
  std::string first = report.substr(0, report.find('\n'));
  for (const char* word : {"modified: ", "added: ", "deleted: "}) {
    const absl::string_view stripped = absl::StripPrefix(first, word);
    if (stripped.size() != first.size()) return std::string(stripped);
  }
  return first;
}

/// The specification of a model without what its size and its zones make of it.
v1::ModelSpec without_region(v1::ModelSpec model) {
  model.clear_n_xi();
  model.clear_n_eta();
  for (v1::TissueLayer& layer : *model.mutable_layers()) layer.clear_elements_through();
  model.mutable_scan_region()->clear_around();
  return model;
}

/// The part of a plan that is about no single zone or film.
v1::SimulationSpec common_of(v1::SimulationSpec plan) {
  plan.clear_model();
  plan.clear_films();
  plan.clear_injections();
  plan.clear_probes();
  plan.clear_ligaments();
  plan.clear_preview();
  plan.mutable_time()->clear_end_s();
  return plan;
}

v1::Film common_of(v1::Film film) {
  film.clear_name();
  film.clear_n_xi();
  film.clear_n_eta();
  film.clear_zones();
  film.clear_walls();
  return film;
}

template <typename Repeated, typename Item>
void add_once(Repeated* items, const Item& item) {
  const bool is_there = std::any_of(items->begin(), items->end(),
                                    [&](const auto& other) { return MessageDifferencer::Equals(other, item); });
  if (!is_there) *items->Add() = item;
}

/// Adds one part after the other to the first.
class PartMerger {
 public:
  explicit PartMerger(const ModelledPart& first) : merged_(first), latest_(first.name) {
    merged_.model.clear_n_xi();
    merged_.model.clear_n_eta();
    for (v1::TissueLayer& layer : *merged_.model.mutable_layers()) layer.clear_elements_through();
    merged_.plan.clear_model();
    for (v1::Film& film : *merged_.plan.mutable_films()) {
      film.clear_n_xi();
      film.clear_n_eta();
      for (const v1::Zone& zone : film.zones()) names_.insert(zone.name());
    }
    for (const v1::Probe& probe : merged_.plan.probes()) probes_.insert(probe.name());
    for (const v1::Ligament& ligament : merged_.plan.ligaments()) ligaments_.insert(ligament.name());
  }

  absl::Status add(const ModelledPart& part) {
    latest_ = part.name;
    if (absl::Status same = check_same(part); !same.ok()) return same;
    add_region(part.model.scan_region().around());
    std::map<std::string, std::string> films, zones;
    for (const v1::Film& film : part.plan.films()) {
      if (absl::Status added = add_film(film, films, zones); !added.ok()) return added;
    }
    for (v1::Injection injection : part.plan.injections()) {
      injection.set_zone(zones[injection.zone()]);
      *merged_.plan.add_injections() = injection;
    }
    for (v1::Probe probe : part.plan.probes()) {
      probe.set_name(make_unique(probe.name(), probes_));
      if (!probe.film().empty() || !part.plan.films().empty()) {
        probe.set_film(films[probe.film().empty() ? part.plan.films(0).name() : probe.film()]);
      }
      *merged_.plan.add_probes() = probe;
    }
    add_ligaments(part.plan, films);
    v1::TimeControl& time = *merged_.plan.mutable_time();
    const auto end_of = [](const v1::TimeControl& of) { return of.has_end_s() ? of.end_s() : kDefaultEnd; };
    time.set_end_s(end_of(time) + end_of(part.plan.time()));
    merged_.plan.set_preview(merged_.plan.preview() || part.plan.preview());
    merged_.name = absl::StrCat(merged_.name, "-and-", part.name).substr(0, kMaxName);
    return absl::OkStatus();
  }

  ModelledPart take() { return std::move(merged_); }

 private:
  absl::Status refuse(const std::string& why) const {
    return absl::FailedPreconditionError(absl::StrCat("the parts '", merged_.name, "' and '", latest_,
                                                      "' touch and have to be simulated together, but ", why));
  }

  absl::Status check_same(const ModelledPart& part) const {
    const std::string tissue = find_difference(without_region(merged_.model), without_region(part.model));
    if (!tissue.empty()) return refuse(absl::StrCat("their models differ in ", tissue));
    const std::string plan = find_difference(common_of(merged_.plan), common_of(part.plan));
    if (!plan.empty()) return refuse(absl::StrCat("their plans differ in ", plan));
    return absl::OkStatus();
  }

  void add_region(const v1::Around& around) {
    v1::Around& all = *merged_.model.mutable_scan_region()->mutable_around();
    for (const std::string& region : around.regions()) {
      const auto& own = all.regions();
      if (std::find(own.begin(), own.end(), region) == own.end()) all.add_regions(region);
    }
    for (const v1::SkinDisc& disc : around.discs()) add_once(all.mutable_discs(), disc);
    if (around.has_margin_mm()) all.set_margin_mm(std::max(all.margin_mm(), around.margin_mm()));
  }

  /// The name itself, or one that says whose it is where another part has taken it.
  std::string make_unique(const std::string& name, std::set<std::string>& taken) const {
    std::string unique = name;
    while (!unique.empty() && !taken.insert(unique).second) unique = absl::StrCat(unique, " (", latest_, ")");
    return unique;
  }

  absl::Status add_film(const v1::Film& film, std::map<std::string, std::string>& films,
                        std::map<std::string, std::string>& zones) {
    v1::Film* into = nullptr;
    for (v1::Film& other : *merged_.plan.mutable_films()) {
      if (other.below_layer() == film.below_layer()) into = &other;
    }
    if (into == nullptr) {
      std::set<std::string> names;
      for (const v1::Film& other : merged_.plan.films()) names.insert(other.name());
      into = merged_.plan.add_films();
      *into = common_of(film);
      into->set_name(make_unique(film.name(), names));
    }
    v1::Film unlike = common_of(*into);
    const std::string difference = find_difference(unlike, common_of(film));
    if (!difference.empty())
      return refuse(absl::StrCat("their films below '", film.below_layer(), "' differ in ", difference));
    films[film.name()] = into->name();
    for (v1::Zone zone : film.zones()) {
      zone.set_name(zones[zone.name()] = make_unique(zone.name(), names_));
      *into->add_zones() = zone;
    }
    for (v1::Wall wall : film.walls()) {
      if (wall.has_between()) {
        wall.mutable_between()->set_first(zones[wall.between().first()]);
        wall.mutable_between()->set_second(zones[wall.between().second()]);
      }
      *into->add_walls() = wall;
    }
    return absl::OkStatus();
  }

  /// An anatomical ligament crosses the films of both parts: it is there once.
  void add_ligaments(const v1::SimulationSpec& plan, std::map<std::string, std::string>& films) {
    const auto& own = merged_.plan.ligaments();
    for (v1::Ligament ligament : plan.ligaments()) {
      const bool is_there = std::any_of(own.begin(), own.end(), [&](const v1::Ligament& other) {
        return ligament.has_anatomical() && other.anatomical() == ligament.anatomical();
      });
      if (is_there) continue;
      ligament.set_name(make_unique(ligament.name(), ligaments_));
      if (!ligament.film().empty()) ligament.set_film(films[ligament.film()]);
      if (!ligament.inner_film().empty()) ligament.set_inner_film(films[ligament.inner_film()]);
      *merged_.plan.add_ligaments() = ligament;
    }
  }

  ModelledPart merged_;
  std::string latest_;
  std::set<std::string> names_;  ///< of zones
  std::set<std::string> probes_;
  std::set<std::string> ligaments_;
};

/// Refuses what belongs to the chart of a part's own model.
absl::Status check_movable(const ModelledPart& part) {
  const auto refuse = [&part](const std::string& what) {
    return absl::FailedPreconditionError(
        absl::StrCat("the part '", part.name, "' touches another and has to be simulated with it, but ", what));
  };
  if (!part.model.scan_region().has_around()) {
    return refuse("its region has corners of its own; leave them out, and the region follows from the zones");
  }
  if (const auto place = find_on_chart(part.plan, "")) {
    return refuse(absl::StrCat(*place,
                               " is drawn on the chart of its own model; say it by a region, a disc around a "
                               "point of the scan, or landmarks"));
  }
  for (const v1::TissueLayer& layer : part.model.layers()) {
    if (find_on_chart(layer, "")) {
      return refuse(absl::StrCat("the thickness of its layer '", layer.name(), "' is drawn on its chart"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ModelledPart> merge_parts(const std::vector<ModelledPart>& parts) {
  for (const ModelledPart& part : parts) {
    if (absl::Status movable = check_movable(part); !movable.ok()) return movable;
  }
  PartMerger merger(parts.front());
  for (auto part = parts.begin() + 1; part != parts.end(); ++part) {
    if (absl::Status added = merger.add(*part); !added.ok()) return added;
  }
  return merger.take();
}

}  // namespace lipofill::server
