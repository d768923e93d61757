#include "client/cpp/scene/tissue_deck_reader.h"

#include <algorithm>
#include <fstream>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace lipofill::client {
namespace {

/// Larger numbers are no hexahedra of a model.
constexpr uint64_t kMostCells = 100'000'000;

/// The value of a parameter of a keyword line, "ELSET=LAYER1_SKIN".
std::string parameter_of(const std::string& line, const std::string& name) {
  for (const absl::string_view part : absl::StrSplit(line, ',')) {
    absl::string_view word = absl::StripAsciiWhitespace(part);
    if (absl::ConsumePrefix(&word, absl::StrCat(name, "="))) return std::string(word);
  }
  return {};
}

/// Reads a deck line by line.
class DeckReader {
 public:
  absl::Status take(const std::string& line) {
    if (absl::StartsWith(line, "**")) return absl::OkStatus();
    if (absl::StartsWith(line, "*")) {
      keyword_ = line;
      layer_ = deck_.layers.size();
      const bool is_elements = absl::StartsWith(line, "*ELEMENT");
      const std::string name = parameter_of(line, is_elements ? "ELSET" : "NAME");
      if (is_elements && absl::StartsWith(name, "LAYER")) deck_.layers.push_back({.name = name});
      if (absl::StartsWith(line, "*MATERIAL")) material_ = name;
      return absl::OkStatus();
    }
    if (absl::StartsWith(keyword_, "*ELEMENT") && layer_ < deck_.layers.size()) return take_element(line);
    if (absl::StartsWith(keyword_, "*ELASTIC") || absl::StartsWith(keyword_, "*HYPERELASTIC"))
      return take_constants(line);
    return absl::OkStatus();
  }

  absl::StatusOr<DeckLayers> finish() {
    if (deck_.layers.empty()) return absl::InvalidArgumentError("has no layers of tissue");
    for (const DeckLayer& layer : deck_.layers) {
      if (!(layer.shear_modulus_mpa > 0.0 && layer.bulk_modulus_mpa > 0.0))
        return absl::InvalidArgumentError(absl::StrCat("has no stiffness for ", layer.name));
    }
    return std::move(deck_);
  }

 private:
  absl::Status take_element(const std::string& line) {
    uint64_t number = 0;
    const std::vector<std::string> words = absl::StrSplit(line, ',');
    if (words.size() != 9 || !absl::SimpleAtoi(words[0], &number) || number < 1 || number > kMostCells)
      return absl::InvalidArgumentError(absl::StrCat("'", line, "' is no hexahedron"));
    if (deck_.layer_of_cell.size() < number) deck_.layer_of_cell.resize(number, deck_.layers.size());
    deck_.layer_of_cell[number - 1] = layer_;
    return absl::OkStatus();
  }

  /// E and nu, or of *HYPERELASTIC, NEO HOOKE C10 = mu / 2 and D1 = 2 / kappa.
  absl::Status take_constants(const std::string& line) {
    const auto layer = std::find_if(deck_.layers.begin(), deck_.layers.end(),
                                    [this](const DeckLayer& each) { return each.name == material_; });
    if (layer == deck_.layers.end()) return absl::OkStatus();
    const std::vector<std::string> words = absl::StrSplit(line, ',');
    double a = 0.0, b = 0.0;
    if (words.size() != 2 || !absl::SimpleAtod(words[0], &a) || !absl::SimpleAtod(words[1], &b) || !(a > 0.0))
      return absl::InvalidArgumentError(absl::StrCat("'", line, "' are no constants of a material"));
    layer->neo_hookean = absl::StartsWith(keyword_, "*HYPERELASTIC");
    layer->shear_modulus_mpa = layer->neo_hookean ? 2.0 * a : a / (2.0 * (1.0 + b));
    layer->bulk_modulus_mpa = layer->neo_hookean ? 2.0 / b : a / (3.0 * (1.0 - 2.0 * b));
    return absl::OkStatus();
  }

  DeckLayers deck_;
  std::string keyword_, material_;
  size_t layer_ = 0;  ///< of the elements that follow
};

}  // namespace

absl::StatusOr<DeckLayers> read_deck_layers(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return absl::InvalidArgumentError(absl::StrCat("cannot read ", file.string()));
  DeckReader reader;
  std::string line;
  for (size_t number = 1; std::getline(stream, line); ++number) {
    if (auto status = reader.take(line); !status.ok())
      return absl::InvalidArgumentError(absl::StrCat(file.string(), ":", number, ": ", status.message()));
  }
  auto deck = reader.finish();
  if (!deck.ok()) return absl::InvalidArgumentError(absl::StrCat(file.string(), " ", deck.status().message()));
  return deck;
}

}  // namespace lipofill::client
