#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "server/sessions/viewer.h"

namespace lipofill::server {

/// The viewers of a simulation. Those who ask for no rate share one: that of screens, and less when
/// they are many, so that sending to all of them takes a twentieth of the time of short steps. For
/// one thread at a time.
///
/// Checked by tests/unit/server/sessions/audience_test.cc.
class Audience {
 public:
  /// Makes the present frame, with the fields of these meshes.
  using MakeFrame = std::function<std::shared_ptr<const Frame>(const std::set<std::string>& meshes)>;

  bool empty() const { return viewers_.empty(); }
  void join(std::shared_ptr<Viewer> viewer);
  void leave(const std::shared_ptr<Viewer>& viewer);

  /// Shows the frame of this simulated time [s] to those who want it. It is made once, and only if
  /// somebody does.
  /// @param at_rest  no step follows soon
  void show(double time_s, bool at_rest, const MakeFrame& make_frame);
  /// Shows a frame to all.
  void offer(const std::shared_ptr<const Frame>& frame);
  /// Takes note that what comes may be of an earlier simulated time than what came.
  void rewind();
  /// Ends the stream of every viewer.
  void close(const absl::Status& status);
  /// Forgets all of them; their streams end with what was offered.
  void dismiss() { viewers_.clear(); }

 private:
  void share_rate();

  std::vector<std::shared_ptr<Viewer>> viewers_;
};

}  // namespace lipofill::server
