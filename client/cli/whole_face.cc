#include "client/cli/whole_face.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace lipofill::client {
namespace {

std::vector<float> values_of(const Array& array) {
  const auto values = array.floats();
  return {values.begin(), values.end()};
}

void set_values(const std::vector<float>& values, Array& array) {
  std::memcpy(array.bytes.data(), values.data(), values.size() * sizeof(float));
}

/// Tells whether a value says that its vertex belongs to no zone of the part.
bool is_nothing(float value) {
  return std::isnan(value) || value == 0.0F;
}

void combine(const Array& part, Array& whole) {
  const std::vector<float> more = values_of(part);
  std::vector<float> values = values_of(whole);
  const bool adds_up = part.field() == "displacement";
  for (size_t k = 0; k < values.size(); ++k) {
    if (adds_up) {
      values[k] += more[k];
    } else if (is_nothing(values[k]) && !std::isnan(more[k])) {
      values[k] = more[k];
    }
  }
  set_values(values, whole);
}

/// The state that needs a look first.
std::string worst_state(const nlohmann::ordered_json& parts) {
  for (const char* state : {"FAILED", "STOPPED", "FINISHED"}) {
    for (const auto& part : parts) {
      if (part.value("state", "") == state) return state;
    }
  }
  return "SETTLED";
}

}  // namespace

absl::Status WholeFace::add(FinalState state) {
  time_s_ = std::max(time_s_, state.frame.time_s);
  if (meshes_.empty()) {
    meshes_ = std::move(state.meshes.arrays);
    fields_ = std::move(state.frame.fields);
    return absl::OkStatus();
  }
  for (Array& field : state.frame.fields) {
    const auto own =
        std::find_if(fields_.begin(), fields_.end(), [&](const Array& other) { return other.name == field.name; });
    if (own == fields_.end()) {
      fields_.push_back(std::move(field));
      continue;
    }
    if (own->shape != field.shape || own->type != field.type) {
      return absl::DataLossError("the parts of the face came on different scans");
    }
    if (own->type == ElementType::kFloat32) combine(field, *own);
  }
  return absl::OkStatus();
}

nlohmann::ordered_json summary_of_face(const std::string& plan, const nlohmann::ordered_json& parts,
                                       const std::vector<std::string>& remarks) {
  nlohmann::ordered_json face = {{"plan", plan}, {"state", worst_state(parts)}};
  for (const char* sum : {"injected_ml", "skin_volume_change_ml"}) {
    double total = 0.0;
    for (const auto& part : parts) total += part.value(sum, 0.0);
    face[sum] = total;
  }
  for (const char* largest : {"time_s", "skin_max_displacement_mm", "max_pressure_pa"}) {
    double most = 0.0;
    for (const auto& part : parts) most = std::max(most, part.value(largest, 0.0));
    face[largest] = most;
  }
  face["zones"] = nlohmann::ordered_json::array();
  face["remarks"] = remarks;
  for (const auto& part : parts) {
    for (auto zone : part.value("zones", nlohmann::ordered_json::array())) {
      zone["part"] = part.value("plan", "");
      face["zones"].push_back(std::move(zone));
    }
    for (const auto& remark : part.value("remarks", nlohmann::ordered_json::array())) {
      face["remarks"].push_back(part.value("plan", "") + ": " + remark.get<std::string>());
    }
  }
  face["parts"] = parts;
  return face;
}

}  // namespace lipofill::client
