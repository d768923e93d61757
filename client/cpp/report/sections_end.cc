// This section says what to know before relying on the report, and where it comes from.

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/cpp/report/catalogue.h"
#include "client/cpp/report/sections.h"

namespace lipofill::client {

Section make_remarks_section(const RecordReader& reader) {
  BulletList remarks;
  remarks.language = reader.language_of_english();
  for (const char* field : {"/planned/summary/remarks", "/deficit/remarks", "/forecast/remarks", "/retention/remarks",
                            "/delivery/remarks", "/model/report/scan_remarks"}) {
    for (std::string& remark : reader.texts(field)) {
      const bool is_new = std::find(remarks.items.begin(), remarks.items.end(), remark) == remarks.items.end();
      if (is_new) remarks.items.push_back(std::move(remark));
    }
  }
  Section section{"remarks", reader.say(texts::kRemarks), {paragraph(reader.say(texts::kNotValidated))}};
  if (remarks.items.empty()) {
    section.blocks.push_back(paragraph(reader.say(texts::kNoRemarks)));
  } else {
    section.blocks.push_back(std::move(remarks));
  }
  return section;
}

Section make_origin_section(const RecordReader& reader) {
  Table table{"hashes", reader.say(texts::kHashes), {reader.say(texts::kFact), reader.say(texts::kValue)}, {}};
  const auto add = [&](const Text& what, const std::string& field) {
    const std::string value = reader.text(field);
    if (!value.empty()) table.rows.push_back({reader.words(reader.say(what)), reader.words(value)});
  };
  add(texts::kPlanHash, "/plan/sha256");
  add(texts::kScanHash, "/scan/sha256");
  add(texts::kTargetHash, "/target/sha256");
  add(texts::kModelHash, "/model/report/content_hash");
  add(texts::kShapeHash, "/planned/summary/state_hash");
  add(texts::kForecastHash, "/forecast/content_hash");
  add(texts::kVersion, "/version");
  return {"origin",
          reader.say(texts::kOrigin),
          {std::move(table), paragraph(reader.say(texts::kRerun)), CodeLine{reader.text("/command")}}};
}

}  // namespace lipofill::client
