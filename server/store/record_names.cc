#include "server/store/record_names.h"

#include "absl/strings/str_cat.h"

namespace lipofill::server {

std::string patient_name(const std::string& patient) {
  return absl::StrCat("patients/", patient);
}
std::string scan_name(const std::string& patient, const std::string& scan) {
  return absl::StrCat("patients/", patient, "/scans/", scan);
}
std::string model_name(const std::string& patient, const std::string& model) {
  return absl::StrCat("patients/", patient, "/models/", model);
}
std::string plan_name(const std::string& patient, const std::string& plan) {
  return absl::StrCat("patients/", patient, "/plans/", plan);
}
std::string simulation_name(const std::string& simulation) {
  return absl::StrCat("simulations/", simulation);
}
std::string checkpoint_name(const std::string& simulation, const std::string& checkpoint) {
  return absl::StrCat("simulations/", simulation, "/checkpoints/", checkpoint);
}

}  // namespace lipofill::server
