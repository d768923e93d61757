#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"
#include "core/simulation/simulation.h"

namespace lipofill::exporting {

struct DeckContent;

/// The tissue of a simulation under its films' present pressure as an Abaqus/CalculiX input deck,
/// for a second opinion by another solver (`ccx tissue`). Units of the deck: mm, N, MPa, tonne.
///
///     *NODE              all nodes at rest, doubled where a film opens: node n of the solver is n + 1
///     *ELEMENT C3D8I     hexahedron e of the solver is e + 1; the order of nodes is the same (HexMesh: 1-4 deep face,
///                        5-8 skin); a set LAYER<k>_<NAME>, *MATERIAL and *SOLID SECTION a layer: *ELASTIC or,
///                        for neo-Hookean layers, *HYPERELASTIC, NEO HOOKE
///     *BOUNDARY          FIXED: held in x, y and z; HELD_X, HELD_Y, HELD_Z: rollers; BONE: nodes of no element
///     SPRING1            elastic supports, to the rest position, a set each stiffness and component
///     *SURFACE           FILM<k>_<NAME>_OUTER and _INNER: the walls of each film on tissue, one face a quadrilateral
///     *DLOAD             the film's pressure on both walls: follows the faces (*STEP, NLGEOM); gravity where it is set
///     *NODE PRINT, FILE  U of NSET SKIN, in the order of the skin mesh; U of all nodes
///
/// The state it describes is that at rest under load: inertia, damping and fat that still flows are
/// not in it; nor are ligaments, fibres across films and prestress, which the deck then names in a
/// comment. Text is made piece by piece, so that a deck of any size takes little memory. Checked by
/// tests/unit/export/calculix_deck_test.cc and, solved by ccx,
/// tests/verification/coupling/calculix_test.cc.
class CalculixDeck {
 public:
  /// Pressure of the films' cells [Pa], in the order of the plan's films; those on other walls than
  /// tissue do not count. FAILED_PRECONDITION for a model without layers, INVALID_ARGUMENT where
  /// the pressures do not fit the films.
  static absl::StatusOr<CalculixDeck> create(const model::FaceModel& model, const plan::SimulationSpec& spec,
                                             const std::vector<Eigen::VectorXd>& pressures);
  /// The same of a simulation as it is.
  static absl::StatusOr<CalculixDeck> create(const simulation::Simulation& simulation);

  CalculixDeck(CalculixDeck&& other) noexcept;
  CalculixDeck& operator=(CalculixDeck&& other) noexcept;
  ~CalculixDeck();

  /// The next piece of the text, whole lines of at most `max_bytes` (at least kLongestLine); empty
  /// at the end.
  std::string read(size_t max_bytes);

  static constexpr size_t kLongestLine = 512;

  /// Roughly what the deck takes in memory, whose text is made as it is read.
  size_t memory_bytes() const;

 private:
  explicit CalculixDeck(std::unique_ptr<DeckContent> content);
  std::unique_ptr<DeckContent> content_;
  size_t section_ = 0;  ///< next to be read
  size_t line_ = 0;     ///< counts the lines of that section; its head is line 0
};

}  // namespace lipofill::exporting
