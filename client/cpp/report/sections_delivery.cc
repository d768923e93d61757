// The list by which the fat is laid.

#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {
namespace {

constexpr Shown kFineMillilitres = {3, 1.0, "mL"};
constexpr Shown kTenths = {1, 1.0, "mm"};

Table entry_table(const RecordReader& reader) {
  Table table{"entries",
              reader.say(texts::kEntries),
              {reader.say(texts::kEntry), reader.say(texts::kZone), reader.say(texts::kPlane),
               reader.say(texts::kPlace), reader.say(texts::kVolume), reader.say(texts::kPasses)},
              {}};
  for (size_t k = 0; k < reader.size("/delivery/entries"); ++k) {
    const std::string entry = absl::StrCat("/delivery/entries/", k);
    table.rows.push_back({reader.words(absl::StrCat(k + 1)), reader.words(reader.name(reader.text(entry + "/zone"))),
                          reader.words(reader.plane(reader.text(entry + "/below_layer"))),
                          Cell{{reader.figure(entry + "/place_mm/x", kTenths),
                                {"; "},
                                reader.figure(entry + "/place_mm/y", kTenths),
                                {"; "},
                                reader.figure(entry + "/place_mm/z", kTenths)}},
                          reader.cell(entry + "/volume_ml", kMillilitres), reader.cell(entry + "/passes", kCount)});
  }
  return table;
}

Table tunnel_table(const RecordReader& reader) {
  Table table{"tunnels",
              reader.say(texts::kTunnels),
              {reader.say(texts::kTunnel), reader.say(texts::kPasses), reader.say(texts::kVolume),
               reader.say(texts::kPassMost)},
              {}};
  for (size_t k = 0; k < reader.size("/delivery/tunnels"); ++k) {
    const std::string tunnel = absl::StrCat("/delivery/tunnels/", k);
    const auto place = [&](const char* key) { return static_cast<int>(reader.number(tunnel + key)) + 1; };
    table.rows.push_back({reader.words(reader.say(texts::kEntryTunnel, place("/entry"), place("/tunnel"))),
                          reader.cell(tunnel + "/passes", kCount), reader.cell(tunnel + "/volume_ml", kFineMillilitres),
                          reader.cell(tunnel + "/most_in_a_pass_ml", kFineMillilitres)});
  }
  return table;
}

}  // namespace

Section make_delivery_section(const RecordReader& reader) {
  Section section{"delivery", reader.say(texts::kDelivery)};
  if (!reader.has("/delivery")) {
    section.blocks.push_back(paragraph(reader.say(texts::kNoDelivery, reader.text("/no_delivery"))));
    return section;
  }
  section.blocks.push_back(entry_table(reader));
  section.blocks.push_back(tunnel_table(reader));
  return section;
}

}  // namespace lipofill::client
