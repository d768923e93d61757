#pragma once

#include <string>
#include <string_view>

namespace lipofill::client {

/// A UID that follows from content, so that equal records have equal UIDs and others do not:
///
///     2.25.<the first 128 bits of SHA-256(kind, 0, content), marked as a UUID of version 8, in decimal>
///
/// (DICOM PS3.5, B.2; RFC 9562). Checked by tests/unit/client/records_test.cc.
/// @param kind  what it is the UID of, such as "series"
std::string uid_of(std::string_view kind, std::string_view content);

}  // namespace lipofill::client
