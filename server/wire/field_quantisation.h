#pragma once

#include "lipofill/v1/frame_service.pb.h"

namespace lipofill::server {

/// Turns a whole FLOAT32 array into UINT16 codes over its box, component by component:
///
///     code = round((value - min) / (max - min) * 65535),   0 where max = min
///
/// and states how far a decoded value may be from the one it stands for: half a step of the widest
/// component, and the rounding of the result to float32. The ends of the box are exact, so that a
/// field of zeros and ones stays one. An array with a value that is not finite, or of another type,
/// stays as it is.
/// Checked by tests/unit/server/wire/field_quantisation_test.cc.
void quantise(v1::ArraySlice& array);

}  // namespace lipofill::server
