#pragma once

#include <map>
#include <string>

#include "lipofill/v1/plan.pb.h"

namespace lipofill::client {

/// --unit on the command line.
inline const std::map<std::string, v1::ScanUnit> kUnitNames = {
    {"mm", v1::MILLIMETRE}, {"cm", v1::CENTIMETRE}, {"m", v1::METRE}};

/// Millimetres a unit has.
inline double millimetres_of(v1::ScanUnit unit) {
  return unit == v1::METRE ? 1000.0 : unit == v1::CENTIMETRE ? 10.0 : 1.0;
}

}  // namespace lipofill::client
