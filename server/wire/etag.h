#pragma once

#include <string>

#include "absl/status/status.h"
#include "server/store/records.h"

namespace lipofill::server {

/// Etag of the content: display name and labels.
std::string make_etag(const PatientRecord& patient);
/// Etag of the state and of the commands taken so far.
std::string make_etag(const SimulationRecord& simulation);

/// Checks an etag. OK when nothing is given or it is the present one, else ABORTED with a violation
/// of `field`: somebody else was first. Checked by tests/unit/server/wire/etag_test.cc.
absl::Status check_etag(const std::string& given, const std::string& present, const std::string& field);

}  // namespace lipofill::server
