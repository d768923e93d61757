#pragma once

#include <string>

namespace lipofill::server {

/// Names as on the wire; requests remember them.
std::string patient_name(const std::string& patient);
std::string scan_name(const std::string& patient, const std::string& scan);
std::string model_name(const std::string& patient, const std::string& model);
std::string plan_name(const std::string& patient, const std::string& plan);
std::string simulation_name(const std::string& simulation);
std::string checkpoint_name(const std::string& simulation, const std::string& checkpoint);

}  // namespace lipofill::server
