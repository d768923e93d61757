#include "client/cpp/requirement.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <limits>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/cpp/errors.h"

namespace lipofill::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr char kAnyZone[] = "ZONE.";

bool is_figure(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE && !field.is_repeated();
}

/// All figures below a message, by their paths.
void list_figures(const Descriptor& message, const std::string& prefix, std::vector<std::string>& names) {
  for (int k = 0; k < message.field_count(); ++k) {
    const FieldDescriptor& field = *message.field(k);
    if (is_figure(field)) names.push_back(prefix + field.name());
    if (field.message_type() == nullptr) continue;
    // One of several is told by its name: those of the evaluation are of zones.
    const char* which = field.is_repeated() ? kAnyZone : "";
    list_figures(*field.message_type(), absl::StrCat(prefix, field.name(), ".", which), names);
  }
}

/// The path of a figure of a zone as the list has it: "zones.ZONE.simulated..." for
/// "zones.masseter.simulated...".
std::string to_listed(const std::string& name) {
  std::vector<std::string> path = absl::StrSplit(name, '.');
  if (path.size() > 2 && path[0] == "zones") path[1] = "ZONE";
  return absl::StrJoin(path, ".");
}

/// The message of a repeated field whose "zone" is this; null where there is none.
const Message* find_zone(const Message& message, const FieldDescriptor* field, const std::string& zone) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  for (int k = 0; k < reflection.FieldSize(message, field); ++k) {
    const Message& one = reflection.GetRepeatedMessage(message, field, k);
    if (one.GetReflection()->GetString(one, one.GetDescriptor()->FindFieldByName("zone")) == zone) return &one;
  }
  return nullptr;
}

/// Statistics that are named without their direction have this one.
constexpr char kDefaultDirection[] = "simulated_to_target.";

absl::StatusOr<Requirement> read_requirement(const std::string& text, const std::vector<std::string>& figures) {
  Requirement requirement;
  requirement.text = text;
  const size_t at = text.find_first_of("<>");
  const bool is_bound = at != std::string::npos && at + 1 < text.size() && text[at + 1] == '=' &&
                        absl::SimpleAtod(text.substr(at + 2), &requirement.bound);
  if (!is_bound) {
    return invalid_fields(
        "no requirement",
        {{"--require", absl::StrCat("is '", text, "', should be as 'p95_mm<=2' or 'hausdorff_mm<=5'")}});
  }
  requirement.at_most = text[at] == '<';
  const std::string name = text.substr(0, at);
  for (const std::string& full : {name, kDefaultDirection + name}) {
    if (std::find(figures.begin(), figures.end(), to_listed(full)) == figures.end()) continue;
    requirement.path = absl::StrSplit(full, '.');
    return requirement;
  }
  return invalid_fields("no figure",
                        {{"--require", absl::StrCat("names '", name, "', there are ", absl::StrJoin(figures, ", "))}});
}

}  // namespace

double Requirement::figure_of(const v1::Evaluation& evaluation) const {
  const Message* message = &evaluation;
  for (size_t k = 0;; ++k) {
    const FieldDescriptor* field = message->GetDescriptor()->FindFieldByName(path[k]);
    if (field->is_repeated()) {
      message = find_zone(*message, field, path[++k]);
      if (message == nullptr) return std::numeric_limits<double>::quiet_NaN();
    } else if (k + 1 < path.size()) {
      message = &message->GetReflection()->GetMessage(*message, field);
    } else if (field->has_presence() && !message->GetReflection()->HasField(*message, field)) {
      return std::numeric_limits<double>::quiet_NaN();
    } else {
      return message->GetReflection()->GetDouble(*message, field);
    }
  }
}

absl::StatusOr<std::vector<Requirement>> read_requirements(const std::vector<std::string>& texts) {
  std::vector<std::string> figures;
  list_figures(*v1::Evaluation::descriptor(), "", figures);
  std::vector<Requirement> requirements;
  for (const std::string& text : texts) {
    auto requirement = read_requirement(text, figures);
    if (!requirement.ok()) return requirement.status();
    requirements.push_back(*std::move(requirement));
  }
  return requirements;
}

}  // namespace lipofill::client
