#include "server/sessions/acknowledgements.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"

namespace lipofill::server {

void Acknowledgements::note_sent(uint64_t epoch, uint64_t sequence) {
  sent_epoch_ = epoch;
  sent_sequence_ = sequence;
  if (most_ > 0) on_their_way_.push_back(sequence);
}

absl::Status Acknowledgements::acknowledge(uint64_t epoch, uint64_t sequence) {
  if (epoch < sent_epoch_) return absl::OkStatus();  // under way when the simulation went back
  if (epoch > sent_epoch_) {
    return field_violation("epoch", absl::StrCat("is ", epoch, ", that of the frames sent is ", sent_epoch_));
  }
  if (sequence > sent_sequence_) {
    return field_violation("sequence", absl::StrCat("is ", sequence, ", the last frame sent is ", sent_sequence_));
  }
  std::erase_if(on_their_way_, [sequence](uint64_t sent) { return sent <= sequence; });
  return absl::OkStatus();
}

}  // namespace lipofill::server
