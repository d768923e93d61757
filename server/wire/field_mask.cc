#include "server/wire/field_mask.h"

#include <google/protobuf/util/field_mask_util.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

using google::protobuf::FieldMask;
using google::protobuf::util::FieldMaskUtil;

constexpr int kMaxPaths = 200;
constexpr size_t kMaxShown = 100;

bool means_everything(const FieldMask& mask) {
  return mask.paths().empty() || (mask.paths_size() == 1 && mask.paths(0) == "*");
}

bool is_field(const google::protobuf::Descriptor& type, const std::string& path) {
  for (const auto part : absl::StrSplit(path, '.')) {
    if (part.empty()) return false;
  }
  return FieldMaskUtil::GetFieldDescriptors(&type, path, nullptr);
}

}  // namespace

absl::Status check_field_mask(const FieldMask& mask, const google::protobuf::Descriptor& type,
                              const std::string& field) {
  if (means_everything(mask)) return absl::OkStatus();
  if (mask.paths_size() > kMaxPaths) {
    return field_violation(field, absl::StrCat("has ", mask.paths_size(), " paths, must have at most ", kMaxPaths));
  }
  FieldViolations violations;
  for (int i = 0; i < mask.paths_size(); ++i) {
    if (is_field(type, mask.paths(i))) continue;
    violations.add(absl::StrCat(field, ".paths[", i, "]"),
                   absl::StrCat("is \"", mask.paths(i).substr(0, kMaxShown), "\", which is no field of ", type.name()));
  }
  return violations.empty() ? absl::OkStatus() : violations.to_status();
}

void apply_field_mask(const FieldMask& mask, google::protobuf::Message& message) {
  if (!means_everything(mask)) FieldMaskUtil::TrimMessage(mask, &message);
}

bool is_masked(const FieldMask& mask, const std::string& path) {
  return means_everything(mask) || std::find(mask.paths().begin(), mask.paths().end(), path) != mask.paths().end();
}

}  // namespace lipofill::server
