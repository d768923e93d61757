#include "client/cli/run_record.h"

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

constexpr char kName[] = "run.json";

}  // namespace

absl::Status write_run_record(const std::filesystem::path& folder, const RunRecord& record) {
  nlohmann::ordered_json document = {{"plan", record.plan},
                                     {"simulation", record.simulation},
                                     {"server", record.server},
                                     {"data", record.data},
                                     {"kept", record.kept}};
  if (record.up) document["up"] = *record.up;
  return write_text_file(folder / kName, document.dump(2) + "\n");
}

absl::StatusOr<RunRecord> read_run_record(const std::filesystem::path& folder) {
  const auto document = read_json_file(folder / kName);
  if (!document.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat(folder.string(), " is not a folder that lipofill run has written: ", document.status().message()));
  }
  try {
    RunRecord record;
    document->at("plan").get_to(record.plan);
    document->at("simulation").get_to(record.simulation);
    document->at("server").get_to(record.server);
    document->at("data").get_to(record.data);
    document->at("kept").get_to(record.kept);
    if (document->contains("up")) record.up = document->at("up").get<std::array<double, 3>>();
    return record;
  } catch (const nlohmann::json::exception& exception) {
    return absl::InvalidArgumentError(absl::StrCat((folder / kName).string(), " is damaged: ", exception.what()));
  }
}

}  // namespace lipofill::client
