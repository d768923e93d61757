#pragma once

#include <nlohmann/json.hpp>

#include "client/cpp/report/answers.h"

namespace lipofill::client {

/// The record of a report, report.json: what the daemon answered under the names of the wire
/// schema, without values of vertices, names of resources and times of computing, so that equal
/// inputs have equal records; and under "volumes" what follows from it for each zone and session:
///
///     prepare_ml = inject_ml (1 + reserve_share),   remaining = volume x share left, without a forecast
///
/// What there is not, is null. Checked by tests/unit/client/report_record_test.cc and
/// tests/integration/cli/report_test.cc.
nlohmann::ordered_json report_record(const ReportAnswers& answers, const ReportFacts& facts);

}  // namespace lipofill::client
