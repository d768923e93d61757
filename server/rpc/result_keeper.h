#pragma once

#include <string>
#include <vector>

#include "server/sessions/session.h"
#include "server/sessions/session_manager.h"
#include "server/store/store.h"

namespace lipofill::server {

/// Puts what sessions compute into the store, as messages of the wire schema, and lets go of sessions that have ended.
class ResultKeeper : public SessionSink {
 public:
  ResultKeeper(Store& store, SessionManager& sessions) : store_(store), sessions_(sessions) {}

  absl::Status append_series(const std::string& id, const std::vector<SeriesEntry>& rows) override;
  absl::Status ended(const std::string& id, const SessionView& view, const Topology& topology,
                     const Frame& frame) override;

 private:
  Store& store_;
  SessionManager& sessions_;
};

}  // namespace lipofill::server
