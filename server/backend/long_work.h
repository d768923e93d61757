#pragma once

#include <google/protobuf/message.h>

#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Work that takes longer than a call should, in an operation. It answers with what the operation
/// responds, packed (pack_response), and takes the operation's id, by which it reports.
using LongWork = std::function<absl::StatusOr<std::string>(const std::string& operation)>;

/// Starts an operation on `target` that does the work in its turn, and ends with what comes of it,
/// whatever that is. An equal request of the caller has the operation that it has already.
/// RESOURCE_EXHAUSTED, with the bound, where too many wait.
/// Checked by tests/integration/service/proposal_test.cc.
///
/// @param waiting  for messages, what waits: "models are waiting to be built"
/// @param doing    for the log, what is begun: "builds a model of"
absl::StatusOr<OperationView> start_long_work(Backend& backend, const std::string& target, const RequestKey& key,
                                              const std::string& waiting, const std::string& doing, LongWork work);

/// The answer to a request that is only to be checked, when nothing is wrong with it.
/// @param stage  for example "checked, not built"
OperationView checked_only(const std::string& target, const google::protobuf::Message& response,
                           const std::string& stage);

}  // namespace lipofill::server
