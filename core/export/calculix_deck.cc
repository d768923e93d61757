#include "core/export/calculix_deck.h"

#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/export/deck_content.h"
#include "core/export/wall_pressure.h"
#include "core/plan/film_layout.h"

namespace lipofill::exporting {
namespace {

/// CalculiX' faces of a hexahedron: 1 is that of nodes 1-4, the deep one; 2 that of nodes 5-8.
enum Face { kDeepFace = 1, kSkinFace = 2 };

FilmWalls find_walls(const geometry::LayeredGrid& grid, const plan::FilmLayout& film, const Eigen::VectorXd& pressure) {
  const auto element = [&](int level, const WallPressure& quad) {
    return (level * grid.n_eta + quad.j) * grid.n_xi + quad.i + 1;
  };
  FilmWalls walls;
  for (const WallPressure& quad : spread_over_wall(grid, film.pieces, pressure)) {
    walls.outer.push_back({element(film.level - 1, quad), kDeepFace, quad.pressure});
    if (film.level == grid.n_levels() - 1) continue;
    walls.inner.push_back({element(film.level, quad), kSkinFace, quad.pressure});
  }
  return walls;
}

std::vector<Attachment> find_attachments(const std::vector<plan::FilmLayout>& films, const mechanics::HeldMesh& held) {
  std::vector<Attachment> attachments;
  size_t walls = 0;
  for (const plan::FilmLayout& film : films) {
    if (film.wall != plan::FilmWallKind::kTissue) continue;
    const coupling::WallNodes& nodes = held.walls[walls++];
    for (size_t place = 0; place < film.bond.open.size(); ++place) {
      if (!film.bond.open[place] || film.bond.stiffness[place] <= 0.0) continue;
      attachments.push_back({nodes.outer[place], nodes.inner[place], film.bond.stiffness[place]});
    }
  }
  return attachments;
}

constexpr char kHeading[] =
    "*HEADING\n"
    "Tissue of a Lipofill simulation under the pressure of its films. Research and planning aid, not a medical "
    "device.\n"
    "** Units: mm, N, MPa, tonne, s. Made for CalculiX; solve with: ccx NAME, the file being NAME.inp.\n"
    "** Nodes are doubled where a film opens. Rest shape, static: no inertia, no damping.\n";

/// A comment on forces of the simulation that the deck leaves out, for whoever compares; empty when
/// there are none.
std::string name_what_is_left_out(const model::FaceModel& model, const plan::SimulationSpec& spec) {
  std::vector<std::string> left_out;
  if (!spec.ligaments.empty()) left_out.push_back("ligaments");
  for (const plan::FilmSpec& film : spec.films) {
    if (film.connective_tissue.stiffness > 0.0) left_out.push_back("fibres across the film " + safe_name(film.name));
  }
  for (const model::TissueLayerSpec& layer : model.layers) {
    if (layer.material.prestress > 0.0) left_out.push_back("prestress of the layer " + safe_name(layer.name));
  }
  return left_out.empty()
             ? ""
             : absl::StrCat("** In the simulation but not in this deck: ", absl::StrJoin(left_out, ", "), "\n");
}

}  // namespace

CalculixDeck::CalculixDeck(std::unique_ptr<DeckContent> content) : content_(std::move(content)) {}
CalculixDeck::CalculixDeck(CalculixDeck&& other) noexcept = default;
CalculixDeck& CalculixDeck::operator=(CalculixDeck&& other) noexcept = default;
CalculixDeck::~CalculixDeck() = default;

absl::StatusOr<CalculixDeck> CalculixDeck::create(const model::FaceModel& model, const plan::SimulationSpec& spec,
                                                  const std::vector<Eigen::VectorXd>& pressures) {
  const geometry::LayeredGrid& grid = model.geometry.grid;
  if (grid.n_layers() == 0)
    return absl::FailedPreconditionError("the model has no layers: there is no tissue to write");
  if (pressures.size() != spec.films.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("there are pressures of ", pressures.size(), " films, must be ", spec.films.size()));
  }
  auto content = std::make_unique<DeckContent>();
  std::vector<plan::FilmLayout> films;
  for (size_t f = 0; f < spec.films.size(); ++f) {
    auto film = plan::place_film(model, spec.films[f]);
    if (!film.ok()) return film.status();
    if (pressures[f].size() != film->grid.n_cells() || !pressures[f].allFinite()) {
      return absl::InvalidArgumentError(absl::StrCat("the pressure of the film '", film->name, "' is not finite on ",
                                                     film->grid.n_cells(), " cells"));
    }
    if (film->wall == plan::FilmWallKind::kTissue) {
      content->films.push_back(find_walls(grid, *film, pressures[f]));
      content->films.back().name = set_name("FILM", f, film->name);
    }
    films.push_back(*std::move(film));
  }
  content->held = mechanics::hold_mesh(model, films);
  content->attachments = find_attachments(films, content->held);
  content->hexahedra_a_layer_level = grid.n_xi * grid.n_eta;
  for (int layer = 0; layer <= grid.n_layers(); ++layer) content->first_level.push_back(grid.first_level(layer));
  content->layers = model.layers;
  content->gravity = spec.gravity;

  content->add(kHeading + name_what_is_left_out(model, spec));
  content->add_nodes();
  content->add_elements();
  content->add_materials();
  content->add_supports();
  content->add_springs();
  content->add_step();
  return CalculixDeck(std::move(content));
}

absl::StatusOr<CalculixDeck> CalculixDeck::create(const simulation::Simulation& simulation) {
  std::vector<Eigen::VectorXd> pressures;
  for (const plan::FilmSpec& film : simulation.spec().films) {
    for (const simulation::FrameField& field : simulation.frame({"film/" + film.name})) {
      if (field.name != "pressure") continue;
      const Eigen::Map<const Eigen::VectorXf> values(field.values.data(),
                                                     static_cast<Eigen::Index>(field.values.size()));
      pressures.push_back(values.cast<double>());
    }
  }
  return create(simulation.model(), simulation.spec(), pressures);
}

size_t CalculixDeck::memory_bytes() const {
  const solid::HexMesh& mesh = content_->held.split.mesh;
  const size_t of_node = 3 * sizeof(double) + sizeof(std::array<bool, 3>) + sizeof(double) + 4 * sizeof(int);
  const size_t of_hexahedron = sizeof(mesh.hexahedra[0]) + 2 * sizeof(int);
  size_t bytes = static_cast<size_t>(mesh.n_nodes()) * of_node + mesh.hexahedra.size() * of_hexahedron +
                 content_->attachments.size() * sizeof(Attachment);
  for (const FilmWalls& walls : content_->films) {
    bytes += (walls.outer.size() + walls.inner.size()) * sizeof(LoadedFace);
  }
  return bytes;
}

std::string CalculixDeck::read(size_t max_bytes) {
  std::string text;
  const std::vector<Section>& sections = content_->sections;
  while (section_ < sections.size()) {
    const Section& section = sections[section_];
    if (line_ > section.n_lines) {
      ++section_;
      line_ = 0;
      continue;
    }
    const std::string next = line_ == 0 ? section.head : section.line(line_ - 1);
    if (!text.empty() && text.size() + next.size() > max_bytes) break;
    text += next;
    ++line_;
  }
  return text;
}

}  // namespace lipofill::exporting
