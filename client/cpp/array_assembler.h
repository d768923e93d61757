#pragma once

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cpp/arrays.h"
#include "lipofill/v1/frame_service.pb.h"

namespace lipofill::client {

/// Puts slices together to whole arrays. Never holds more than what was received: a slice that
/// claims a huge array costs nothing. UINT16 codes become the float32 values they stand for.
/// Checked by tests/unit/client/array_assembler_test.cc.
class ArrayAssembler {
 public:
  /// Adds a slice. DATA_LOSS for one that does not follow the one before it, or that goes beyond
  /// the array's own shape.
  absl::Status add(const v1::ArraySlice& slice);

  /// The arrays in the order they came, and starts anew. DATA_LOSS where bytes are missing.
  absl::StatusOr<std::vector<Array>> take();

 private:
  /// The part of an array received so far, and what decodes it.
  struct Growing {
    Array array;
    bool is_coded = false;
    std::vector<double> box_min;
    std::vector<double> box_max;

    size_t bytes_each() const { return is_coded ? sizeof(uint16_t) : element_size(array.type); }
  };
  static absl::StatusOr<Growing> begin(const v1::ArraySlice& slice);
  static void decode(Growing& coded);
  bool has(const std::string& name) const;

  std::vector<Growing> arrays_;
};

}  // namespace lipofill::client
