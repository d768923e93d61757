#pragma once

#include <nlohmann/json.hpp>

#include "client/cpp/report/answers.h"

namespace lipofill::client {

/// Tells how much to prepare, to inject and to keep, by zone with its plane, and by session: from
/// the forecast where there is one, else from the plan and the retention of the last month.
nlohmann::ordered_json record_of_volumes(const ReportAnswers& answers, double reserve_share);

}  // namespace lipofill::client
