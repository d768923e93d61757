#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// A layer of tissue as a deck of `lipofill export --deck` has it.
struct DeckLayer {
  std::string name;  ///< "LAYER1_SKIN"
  bool neo_hookean = false;
  double shear_modulus_mpa = 0.0;
  double bulk_modulus_mpa = 0.0;
};

/// The layers of a deck, and which of them each hexahedron is of.
struct DeckLayers {
  std::vector<DeckLayer> layers;
  std::vector<size_t> layer_of_cell;  ///< by the hexahedron's number in the simulation, from 0
};

/// Reads elements and materials of a deck that this project has written. INVALID_ARGUMENT, naming
/// the file and the line, for another one. Checked by tests/unit/client/tissue_fields_test.cc.
absl::StatusOr<DeckLayers> read_deck_layers(const std::filesystem::path& file);

}  // namespace lipofill::client
