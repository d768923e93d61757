#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::server {

/// True for error numbers that say that there is no room: a full disk, a quota, a limit on the size
/// of files.
bool is_out_of_space(int error_number);

/// Makes the error of a file: RESOURCE_EXHAUSTED when there is no room, else UNAVAILABLE; it says
/// what could not be done, and why.
absl::Status file_error(const std::string& what, int error_number);

/// Writes a file whole or not at all, also when the machine dies: beside its place, to the medium,
/// then into its place. Its directory is made when it is missing. Errors as file_error() gives
/// them; nothing is left behind then.
/// Checked by tests/unit/server/store/checkpoint_files_test.cc.
absl::Status write_durably(const std::filesystem::path& path, std::string_view bytes);

/// Tells where write_durably() writes before it puts a file into its place.
std::filesystem::path draft_of(const std::filesystem::path& path);

/// Waits until what was written to a file, or which entries a directory has, is on the medium.
absl::Status flush_to_medium(const std::filesystem::path& path);

/// The bytes of a file. NOT_FOUND without one, RESOURCE_EXHAUSTED before any is read when there are
/// more than `max_bytes`.
absl::StatusOr<std::string> read_whole_file(const std::filesystem::path& path, uint64_t max_bytes);

}  // namespace lipofill::server
