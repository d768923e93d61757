// Landmarks as files of other programs, in millimetres and LPS.

#include <libxml/tree.h>

#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cpp/landmark_formats.h"

namespace lipofill::client {
namespace {

using Points = std::vector<std::pair<std::string, Point>>;

std::string number(double value) {
  return absl::StrFormat("%.10g", value);
}

std::string in_marks(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  return absl::StrCat("\"", absl::StrReplaceAll(name, {{"\"", "\"\""}}), "\"");
}

void set(xmlNode* node, const char* key, const std::string& value) {
  xmlNewProp(node, reinterpret_cast<const xmlChar*>(key), reinterpret_cast<const xmlChar*>(value.c_str()));
}

}  // namespace

std::string write_slicer_markups(const Points& points) {
  using nlohmann::ordered_json;
  ordered_json controls = ordered_json::array();
  for (size_t k = 0; k < points.size(); ++k) {
    controls.push_back({{"id", std::to_string(k + 1)},
                        {"label", points[k].first},
                        {"description", ""},
                        {"associatedNodeID", ""},
                        {"position", points[k].second},
                        {"orientation", {-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0}},
                        {"selected", true},
                        {"locked", false},
                        {"visibility", true},
                        {"positionStatus", "defined"}});
  }
  const ordered_json document = {
      {"@schema",
       "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
       "markups-schema-v1.0.3.json#"},
      {"markups",
       {{{"type", "Fiducial"},
         {"coordinateSystem", "LPS"},
         {"coordinateUnits", "mm"},
         {"locked", false},
         {"fixedNumberOfControlPoints", false},
         {"labelFormat", "%N-%d"},
         {"lastUsedControlPointNumber", points.size()},
         {"controlPoints", controls}}}}};
  return document.dump(1) + "\n";
}

std::string write_fcsv(const Points& points) {
  std::string text =
      "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
      "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";
  for (size_t k = 0; k < points.size(); ++k) {
    const auto& [name, at] = points[k];
    absl::StrAppend(&text, k + 1, ",", number(at[0]), ",", number(at[1]), ",", number(at[2]), ",0,0,0,1,1,1,0,",
                    in_marks(name), ",,\n");
  }
  return text;
}

std::string write_picked_points(const Points& points) {
  const std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)> document(xmlNewDoc(nullptr), &xmlFreeDoc);
  const auto name_of = [](const char* name) { return reinterpret_cast<const xmlChar*>(name); };
  xmlCreateIntSubset(document.get(), name_of("PickedPoints"), nullptr, nullptr);
  xmlNode* root = xmlNewNode(nullptr, name_of("PickedPoints"));
  xmlDocSetRootElement(document.get(), root);
  for (const auto& [name, at] : points) {
    xmlNode* node = xmlNewChild(root, nullptr, name_of("point"), nullptr);
    set(node, "active", "1");
    set(node, "x", number(at[0]));
    set(node, "y", number(at[1]));
    set(node, "z", number(at[2]));
    set(node, "name", name);
  }
  xmlChar* bytes = nullptr;
  int size = 0;
  xmlDocDumpFormatMemoryEnc(document.get(), &bytes, &size, "UTF-8", 1);
  std::string text(reinterpret_cast<const char*>(bytes), static_cast<size_t>(size));
  xmlFree(bytes);
  return text;
}

std::string write_landmark_table(const Points& points) {
  std::string text = "name,x_mm,y_mm,z_mm\n";
  for (const auto& [name, at] : points) {
    absl::StrAppend(&text, in_marks(name), ",", number(at[0]), ",", number(at[1]), ",", number(at[2]), "\n");
  }
  return text;
}

}  // namespace lipofill::client
