#include "client/cpp/dicom/frame_fields.h"

#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"

namespace lipofill::client {
namespace {

/// A list of the offsets of ten thousand frames has less.
constexpr Uint32 kMaxTextBytes = 1 << 20;

}  // namespace

FrameFields::FrameFields(DcmItem* data_set, unsigned long frame) : data_set_(data_set) {
  if (data_set->findAndGetSequenceItem(DCM_SharedFunctionalGroupsSequence, shared_, 0).bad()) shared_ = nullptr;
  if (data_set->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, own_, static_cast<long>(frame)).bad())
    own_ = nullptr;
}

std::string FrameFields::text(const DcmTagKey& group, const DcmTagKey& tag) const {
  for (DcmItem* const item : {own_, shared_}) {
    DcmItem* macro = nullptr;
    if (item == nullptr || item->findAndGetSequenceItem(group, macro, 0).bad()) continue;
    const std::string found = text_of(macro, tag);
    if (!found.empty()) return found;
  }
  return text_of(data_set_, tag);
}

std::optional<std::vector<double>> FrameFields::numbers(const DcmTagKey& group, const DcmTagKey& tag,
                                                        size_t count) const {
  std::vector<double> values;
  const std::string all = text(group, tag);
  for (const auto& word : absl::StrSplit(all, '\\', absl::SkipEmpty())) {
    double value = 0.0;
    if (!absl::SimpleAtod(word, &value) || !std::isfinite(value)) return std::nullopt;
    values.push_back(value);
  }
  if (values.size() != count) return std::nullopt;
  return values;
}

std::string text_of(DcmItem* data_set, const DcmTagKey& tag) {
  // A damaged file may claim a text of any length, for which memory would be taken.
  DcmElement* element = nullptr;
  if (data_set->findAndGetElement(tag, element).bad() || element->getLength() > kMaxTextBytes) return {};
  OFString text;
  if (data_set->findAndGetOFStringArray(tag, text).bad()) return {};
  return std::string(absl::StripAsciiWhitespace(absl::string_view(text.c_str(), text.size())));
}

int64_t whole_number_of(DcmItem* data_set, const DcmTagKey& tag, int64_t otherwise) {
  int64_t number = 0;
  const std::string text = text_of(data_set, tag);
  return absl::SimpleAtoi(text, &number) ? number : otherwise;
}

}  // namespace lipofill::client
