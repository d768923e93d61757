#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "lipofill/v1/frame_service.pb.h"

namespace lipofill::server {

/// The values of an array, by its name, among those of a result; DATA_LOSS where there is none.
template <typename T, typename Arrays>
absl::StatusOr<std::vector<T>> read_array(const Arrays& arrays, const std::string& name) {
  for (const v1::ArraySlice& array : arrays) {
    if (array.name() != name) continue;
    std::vector<T> values(array.data().size() / sizeof(T));
    std::memcpy(values.data(), array.data().data(), values.size() * sizeof(T));
    return values;
  }
  return absl::DataLossError(absl::StrCat("the result has no array ", name));
}

}  // namespace lipofill::server
