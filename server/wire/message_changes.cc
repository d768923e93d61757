#include "server/wire/message_changes.h"

#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::util::MessageDifferencer;
using Path = std::vector<MessageDifferencer::SpecificField>;

constexpr size_t kMaxShown = 64;

std::string shortened(const std::string& text) {
  return text.size() <= kMaxShown ? text : absl::StrCat(text.substr(0, kMaxShown), "...");
}

std::string key_of(const Message& entry) {
  const FieldDescriptor* key = entry.GetDescriptor()->map_key();
  if (key->cpp_type() == FieldDescriptor::CPPTYPE_STRING) return entry.GetReflection()->GetString(entry, key);
  std::string text;
  google::protobuf::TextFormat::PrintFieldValueToString(entry, key, -1, &text);
  return text;
}

/// The path as in the violations of a request: "films[0].injections[1].volume_ml". An element that
/// moved has the place that it has now, one that was taken out the place that it had.
std::string text_of(const Path& path, bool is_gone) {
  std::string text;
  for (const auto& step : path) {
    if (step.field == nullptr) continue;
    if (step.field->containing_type()->options().map_entry()) continue;
    absl::StrAppend(&text, text.empty() ? "" : ".", step.field->name());
    const Message* entry = step.map_entry2 != nullptr ? step.map_entry2 : step.map_entry1;
    if (entry != nullptr) {
      absl::StrAppend(&text, "[", key_of(*entry), "]");
    } else if (step.field->is_repeated()) {
      const bool is_old = is_gone && &step == &path.back();
      absl::StrAppend(&text, "[", is_old ? step.index : step.new_index, "]");
    }
  }
  return text;
}

std::string value_of(const Message& message, const FieldDescriptor* field, int index) {
  const bool is_message = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
  if (is_message) return "";
  std::string text;
  google::protobuf::TextFormat::PrintFieldValueToString(message, field, field->is_repeated() ? index : -1, &text);
  return shortened(field->type() == FieldDescriptor::TYPE_BYTES ? absl::CHexEscape(text) : text);
}

/// Notes every change that the differencer comes to.
class ChangeNotes : public MessageDifferencer::Reporter {
 public:
  explicit ChangeNotes(size_t most) : most_(most) {}

  void ReportAdded(const Message&, const Message& after, const Path& path) override {
    const auto& last = path.back();
    const std::string value = value_of(after, last.field, last.new_index);
    note(path, value.empty() ? "is new" : absl::StrCat("is new: ", value));
  }
  void ReportDeleted(const Message& before, const Message&, const Path& path) override {
    const auto& last = path.back();
    const std::string value = value_of(before, last.field, last.index);
    note(path, value.empty() ? "was taken out" : absl::StrCat("was ", value, ", was taken out"), true);
  }
  void ReportModified(const Message& before, const Message& after, const Path& path) override {
    const auto& last = path.back();
    // What contains a change is told of too, after it.
    if (last.field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) return;
    note(path, absl::StrCat("was ", value_of(before, last.field, last.index), ", is ",
                            value_of(after, last.field, last.new_index)));
  }

  std::vector<FieldViolation> take() { return std::move(changes_); }

 private:
  void note(const Path& path, const std::string& what, bool is_gone = false) {
    if (changes_.size() < most_) changes_.push_back({text_of(path, is_gone), what});
  }

  const size_t most_;
  std::vector<FieldViolation> changes_;
};

}  // namespace

std::vector<FieldViolation> changes_between(const Message& before, const Message& after, size_t most) {
  ChangeNotes notes(most);
  MessageDifferencer differencer;
  differencer.ReportDifferencesTo(&notes);
  differencer.Compare(before, after);
  return notes.take();
}

}  // namespace lipofill::server
