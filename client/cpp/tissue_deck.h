#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/connection.h"

namespace lipofill::client {

/// A deck that was written to a file.
struct TissueDeckFile {
  uint64_t bytes = 0;
  double time_s = 0.0;  ///< simulated time of the state it describes
};

/// Bytes received so far.
using DeckProgress = std::function<void(uint64_t)>;

/// Writes the tissue of a simulation as an Abaqus/CalculiX input deck, piece by piece as it comes.
/// The file is there whole or not at all: an interrupted download leaves what was there before.
/// INVALID_ARGUMENT when it cannot be written. Checked by tests/integration/cli/commands_test.cc.
/// @param simulation  simulations/{simulation}
absl::StatusOr<TissueDeckFile> download_tissue_deck(const Connection& connection, const std::string& simulation,
                                                    const std::filesystem::path& file,
                                                    const DeckProgress& progress = {});

}  // namespace lipofill::client
