#pragma once

#include <map>
#include <string>

#include "lipofill/v1/plan.pb.h"

namespace lipofill::client {

/// --unit on the command line.
inline const std::map<std::string, v1::ScanUnit> kUnitNames = {
    {"mm", v1::MILLIMETRE}, {"cm", v1::CENTIMETRE}, {"m", v1::METRE}};

}  // namespace lipofill::client
