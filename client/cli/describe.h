#pragma once

#include <string>

#include "lipofill/v1/operation_service.pb.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/planning_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

// These describe one thing for people: in a few lines, or in one line where it stands in a list.
std::string describe(const v1::Patient& patient);
std::string describe(const v1::Scan& scan);
/// Tells what was found in the file of a scan, what was passed over, what a model will mend.
std::string surface_text(const v1::ScanReport& report);
std::string describe(const v1::Model& model);

/// Thickness of the layers, a line each, and what was found of the bone.
std::string layers_text(const v1::ModelReport& report);
std::string describe(const v1::Operation& operation);
std::string describe(const v1::Evaluation& evaluation);
std::string describe(const v1::CheckPlanResponse& check);
std::string describe(const v1::Target& target);
std::string describe(const v1::Deficit& deficit);
std::string list_line(const v1::Patient& patient);
std::string list_line(const v1::Scan& scan);
std::string list_line(const v1::Model& model);
std::string list_line(const v1::Operation& operation);
std::string list_line(const v1::Simulation& simulation);

}  // namespace lipofill::client
