// Landmark files that have a structure of their own: JSON of 3D Slicer, XML of MeshLab.

#include "client/cpp/landmark_formats.h"

#include <libxml/parser.h>
#include <libxml/tree.h>

#include <cmath>
#include <memory>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

using nlohmann::json;

constexpr size_t kMostPoints = 100'000;

absl::Status wrong(const std::string& what) {
  return absl::InvalidArgumentError(what);
}

absl::Status add(LandmarkList& list, std::string name, const Point& point, const std::string& where) {
  for (const double x : point) {
    if (!std::isfinite(x)) return wrong(absl::StrCat(where, " has a coordinate that is not finite"));
  }
  if (list.points.size() >= kMostPoints) return wrong(absl::StrCat("more than ", kMostPoints, " points"));
  list.points.emplace_back(std::move(name), point);
  return absl::OkStatus();
}

std::string text_of(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// True for RAS; LPS is what the schema of markups has by default.
absl::StatusOr<bool> is_ras(const json& markup) {
  const std::string system = text_of(markup, "coordinateSystem");
  if (system == "RAS" || system == "0") return true;
  if (system == "LPS" || system == "1" || system.empty()) return false;
  return wrong(absl::StrCat("coordinateSystem is '", system, "', must be LPS or RAS"));
}

/// "mm", or a code with its meaning as ["mm", "UCUM", "millimeter"].
absl::StatusOr<std::optional<double>> unit_of(const json& markup) {
  const auto found = markup.find("coordinateUnits");
  if (found == markup.end()) return std::nullopt;
  const json& unit = found->is_array() && !found->empty() ? found->front() : *found;
  if (unit == "mm") return 1.0;
  if (unit == "cm") return 10.0;
  if (unit == "m") return 1000.0;
  if (unit == "um") return 0.001;
  return wrong(absl::StrCat("coordinateUnits is ", unit.dump(), ", must be mm, cm, m or um"));
}

absl::Status add_control_point(const json& point, bool from_ras, const std::string& where, LandmarkList& list) {
  if (!point.is_object()) return wrong(absl::StrCat(where, " is not an object"));
  const std::string status = text_of(point, "positionStatus");
  std::string name = text_of(point, "label");
  if ((!status.empty() && status != "defined") || name.empty()) {
    ++list.passed_over;
    return absl::OkStatus();
  }
  const auto position = point.find("position");
  if (position == point.end() || !position->is_array() || position->size() != 3) {
    return wrong(absl::StrCat(where, " has no position of three numbers"));
  }
  Point at{};
  for (size_t c = 0; c < 3; ++c) {
    const json& x = (*position)[c];
    if (!x.is_number()) return wrong(absl::StrCat(where, ".position[", c, "] is not a number"));
    at[c] = from_ras && c < 2 ? 0.0 - x.get<double>() : x.get<double>();
  }
  return add(list, std::move(name), at, where);
}

absl::Status add_markup(const json& markup, const std::string& where, LandmarkList& list) {
  if (!markup.is_object()) return wrong(absl::StrCat(where, " is not an object"));
  const auto points = markup.find("controlPoints");
  if (points == markup.end()) return absl::OkStatus();
  if (!points->is_array()) return wrong(absl::StrCat(where, ".controlPoints is not a list"));
  const auto ras = is_ras(markup);
  if (!ras.ok()) return ras.status();
  const auto unit = unit_of(markup);
  if (!unit.ok()) return unit.status();
  if (!list.points.empty() && *unit != list.mm_per_unit) return wrong("the markups of the file have different units");
  list.mm_per_unit = *unit;
  list.was_ras = list.was_ras || *ras;
  for (size_t k = 0; k < points->size(); ++k) {
    const absl::Status added =
        add_control_point((*points)[k], *ras, absl::StrCat(where, ".controlPoints[", k, "]"), list);
    if (!added.ok()) return added;
  }
  return absl::OkStatus();
}

using XmlDocument = std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)>;

std::string attribute(xmlNode* node, const char* name) {
  const std::unique_ptr<xmlChar, decltype(xmlFree)> value(xmlGetProp(node, reinterpret_cast<const xmlChar*>(name)),
                                                          xmlFree);
  return value == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(value.get()));
}

bool is_element(const xmlNode* node, const char* name) {
  return node->type == XML_ELEMENT_NODE && xmlStrEqual(node->name, reinterpret_cast<const xmlChar*>(name)) != 0;
}

absl::Status add_picked_point(xmlNode* node, LandmarkList& list) {
  std::string name = attribute(node, "name");
  if (attribute(node, "active") == "0" || name.empty()) {
    ++list.passed_over;
    return absl::OkStatus();
  }
  const std::string where = absl::StrCat("line ", xmlGetLineNo(node), ": point '", name, "'");
  Point at{};
  for (const auto& [axis, key] : {std::pair(0u, "x"), std::pair(1u, "y"), std::pair(2u, "z")}) {
    const std::string text = attribute(node, key);
    if (!absl::SimpleAtod(text, &at[axis])) {
      return wrong(absl::StrCat(where, " has ", key, "=\"", text, "\", which is not a number"));
    }
  }
  return add(list, std::move(name), at, where);
}

}  // namespace

absl::StatusOr<LandmarkList> parse_slicer_markups(const json& document) {
  const auto markups = document.is_object() ? document.find("markups") : document.end();
  if (!document.is_object() || markups == document.end() || !markups->is_array()) {
    return wrong("has no list \"markups\"");
  }
  LandmarkList list;
  for (size_t k = 0; k < markups->size(); ++k) {
    const absl::Status added = add_markup((*markups)[k], absl::StrCat("markups[", k, "]"), list);
    if (!added.ok()) return added;
  }
  return list;
}

absl::StatusOr<LandmarkList> parse_picked_points(std::string_view text) {
  // A few entities that name each other would grow to gigabytes; MeshLab declares none.
  if (text.find("<!ENTITY") != std::string_view::npos) return wrong("declares entities, which are not read");
  // Nothing is fetched, and libxml2 bounds depth and names.
  const XmlDocument document(xmlReadMemory(text.data(), static_cast<int>(text.size()), nullptr, nullptr,
                                           XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING),
                             &xmlFreeDoc);
  xmlNode* root = document == nullptr ? nullptr : xmlDocGetRootElement(document.get());
  if (root == nullptr) {
    const xmlError* error = xmlGetLastError();
    return wrong(absl::StrCat("is not XML", error == nullptr ? "" : absl::StrCat(", see line ", error->line)));
  }
  if (!is_element(root, "PickedPoints")) return wrong("has no element PickedPoints");
  LandmarkList list;
  for (xmlNode* node = root->children; node != nullptr; node = node->next) {
    if (!is_element(node, "point")) continue;
    if (const absl::Status added = add_picked_point(node, list); !added.ok()) return added;
  }
  return list;
}

}  // namespace lipofill::client
