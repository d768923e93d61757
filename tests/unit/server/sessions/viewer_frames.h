#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <variant>
#include <vector>

#include "server/sessions/viewer.h"

namespace lipofill::server {

/// A frame of epoch 5.
inline std::shared_ptr<const Frame> frame(uint64_t sequence, double time_s = 0.0, bool end = false,
                                          size_t floats = 10) {
  auto made = std::make_shared<Frame>();
  made->epoch = 5;
  made->sequence = sequence;
  made->time_s = time_s;
  made->end = end;
  made->fields.push_back({"skin", "pressure", "Pa", simulation::FieldLocation::kPoint, 1, std::vector<float>(floats)});
  return made;
}

inline FrameToSend take_frame(Viewer& viewer) {
  const ToSend next = viewer.take();
  const auto* taken = std::get_if<FrameToSend>(&next);
  EXPECT_NE(taken, nullptr);
  return taken == nullptr ? FrameToSend{} : *taken;
}

inline bool has_nothing(Viewer& viewer) {
  return std::holds_alternative<std::monostate>(viewer.take());
}

inline absl::Status take_end(Viewer& viewer) {
  const ToSend next = viewer.take();
  const auto* end = std::get_if<EndOfStream>(&next);
  return end == nullptr ? absl::UnknownError("not the end") : end->status;
}

}  // namespace lipofill::server
