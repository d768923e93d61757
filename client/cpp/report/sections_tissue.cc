// The tissue of the model, and how well it is known.

#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {
namespace {

Table layer_table(const RecordReader& reader) {
  Table table{"layers",
              reader.say(texts::kLayers),
              {reader.say(texts::kLayer), reader.say(texts::kThickness), reader.say(texts::kModulus),
               reader.say(texts::kPoisson), reader.say(texts::kDensity), reader.say(texts::kLaw)},
              {}};
  for (size_t k = 0; k < reader.size("/model/spec/layers"); ++k) {
    const std::string spec = absl::StrCat("/model/spec/layers/", k);
    const std::string report = absl::StrCat("/model/report/layers/", k);
    table.rows.push_back({reader.words(reader.name(reader.text(spec + "/name"))),
                          reader.cell_with_interval(report + "/mean_thickness_mm", report + "/min_thickness_mm",
                                                    report + "/max_thickness_mm", kMillimetres),
                          reader.cell(spec + "/youngs_modulus_kpa", {1, 1.0, "kPa"}),
                          reader.cell(spec + "/poisson_ratio", {3, 1.0, ""}),
                          reader.cell(spec + "/density_kg_m3", {0, 1.0, "kg/m\u00b3"}),
                          reader.words(reader.name(reader.text(spec + "/law")))});
  }
  return table;
}

std::string law_text(const RecordReader& reader, const std::string& law) {
  if (law == "NORMAL") return reader.say(texts::kNormal);
  if (law == "LOG_NORMAL") return reader.say(texts::kLogNormal);
  return reader.say(law == "UNIFORM" ? texts::kUniform : texts::kTriangular);
}

Cell distribution_cell(const RecordReader& reader, const std::string& field) {
  const Shown shown = {2, 1.0, ""};
  Cell cell = reader.words(law_text(reader, reader.text(field + "/law")));
  const auto add = [&](const Text& before, const std::string& key) {
    if (!reader.has(field + key)) return;
    cell.pieces.push_back({reader.say(before)});
    cell.pieces.push_back(reader.figure(field + key, shown));
  };
  add(texts::kAround, "/centre");
  add(texts::kSpread, "/spread");
  add(texts::kWithin, "/low");
  add(texts::kTo, "/high");
  return cell;
}

Table input_table(const RecordReader& reader, const std::string& inputs) {
  Table table{"inputs",
              reader.say(texts::kInputs),
              {reader.say(texts::kInput), reader.say(texts::kDistribution), reader.say(texts::kBasis),
               reader.say(texts::kSource)},
              {}};
  for (size_t k = 0; k < reader.size(inputs); ++k) {
    const std::string input = absl::StrCat(inputs, "/", k);
    const bool assumed = reader.at(input + "/assumed") == true;
    table.rows.push_back({reader.words(input_text(reader, input)), distribution_cell(reader, input + "/distribution"),
                          reader.words(reader.say(assumed ? texts::kAssumed : texts::kPublished)),
                          reader.english(reader.text(input + "/source"))});
  }
  return table;
}

}  // namespace

std::string input_text(const RecordReader& reader, const std::string& field) {
  const std::string quantity = reader.text(field + "/quantity");
  const std::string name = reader.name(reader.text(field + "/name"));
  if (quantity == "LAYER_MODULUS") return reader.say(texts::kLayerModulus, name);
  if (quantity == "LAYER_THICKNESS") return reader.say(texts::kLayerThickness, name);
  if (quantity == "ZONE_VOLUME") return reader.say(texts::kDeliveredVolume, name);
  if (quantity == "PLACE_XI") return reader.say(texts::kPlaceXi);
  if (quantity == "PLACE_ETA") return reader.say(texts::kPlaceEta);
  return reader.say(texts::kRetentionInput);
}

Section make_tissue_section(const RecordReader& reader) {
  Section section{"tissue", reader.say(texts::kTissue), {layer_table(reader)}};
  if (reader.size("/inputs") == 0) {
    section.blocks.push_back(paragraph(reader.say(texts::kNoInputs)));
  } else {
    section.blocks.push_back(input_table(reader, "/inputs"));
  }
  return section;
}

}  // namespace lipofill::client
