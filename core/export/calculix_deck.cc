#include "core/export/calculix_deck.h"

#include <array>
#include <functional>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/units.h"
#include "core/export/wall_pressure.h"
#include "core/mechanics/tissue_setup.h"
#include "core/plan/film_layout.h"

namespace lipofill::exporting {
namespace {

constexpr size_t kNumbersALine = 10;
constexpr std::array<const char*, 3> kAxis = {"X", "Y", "Z"};

/// A number as wide as CalculiX reads: 20 characters.
std::string number(double value) {
  return absl::StrFormat("%.12e", value);
}

/// A name of the plan as a part of a set's name: letters, digits and underscores.
std::string safe_name(const std::string& name) {
  constexpr size_t kLongestName = 40;
  std::string safe;
  for (const char c : name.substr(0, kLongestName)) {
    const auto letter = static_cast<unsigned char>(c);
    safe += absl::ascii_isalnum(letter) ? absl::ascii_toupper(letter) : '_';
  }
  return safe;
}

std::string set_name(const char* kind, size_t index, const std::string& name) {
  return absl::StrCat(kind, index + 1, "_", safe_name(name));
}

/// A face of a hexahedron under pressure; both numbered from 1.
struct LoadedFace {
  int element = 0;
  int face = 0;
  double pressure = 0.0;  ///< [Pa]
};

/// CalculiX' faces of a hexahedron: 1 is that of nodes 1-4, the deep one; 2 that of nodes 5-8.
enum Face { kDeepFace = 1, kSkinFace = 2 };

/// The walls of one film.
struct FilmWalls {
  std::string name;
  std::vector<LoadedFace> outer;
  std::vector<LoadedFace> inner;  ///< empty where the film lies on bone
};

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

/// Two nodes that the edge of a zone holds together (plan/zone_bond.h).
struct Attachment {
  int outer = 0;
  int inner = 0;
  double stiffness = 0.0;  ///< [N/m]
};

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

/// A part of the deck: a head of one or more lines, and lines that are made when they are read.
struct Section {
  std::string head;
  size_t n_lines = 0;
  std::function<std::string(size_t)> line;
};

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

/// Owns what the lines are made from, so that the sections may refer to it.
struct CalculixDeck::Content {
  mechanics::HeldMesh held;
  int hexahedra_a_layer_level = 0;
  std::vector<int> first_level;  ///< each layer begins there; one more ends the last
  std::vector<model::TissueLayerSpec> layers;
  std::vector<FilmWalls> films;
  std::vector<Attachment> attachments;
  size_t n_springs = 0;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  std::vector<Section> sections;

  std::string layer_set(size_t layer) const { return set_name("LAYER", layer, layers[layer].name); }

  void add(std::string head) { sections.push_back({std::move(head), 0, nullptr}); }
  void add_node_set(const std::string& name, std::vector<int> nodes);
  void add_nodes();
  void add_elements();
  void add_materials();
  void add_supports();
  void add_springs();
  void add_attachments();
  void add_spring_set(const char* type, const std::string& set, const std::string& directions, double stiffness,
                      std::vector<std::string> ends);
  void add_surface(const std::string& name, const std::vector<LoadedFace>& faces);
  void add_step();
  void add_loads();
};

void CalculixDeck::Content::add_node_set(const std::string& name, std::vector<int> nodes) {
  if (nodes.empty()) return;
  const size_t n_lines = (nodes.size() + kNumbersALine - 1) / kNumbersALine;
  sections.push_back({absl::StrCat("*NSET, NSET=", name, "\n"), n_lines, [nodes = std::move(nodes)](size_t line) {
                        std::string text;
                        const size_t end = std::min(nodes.size(), (line + 1) * kNumbersALine);
                        for (size_t k = line * kNumbersALine; k < end; ++k) absl::StrAppend(&text, nodes[k] + 1, ",");
                        return text + "\n";
                      }});
}

void CalculixDeck::Content::add_nodes() {
  const auto line = [this](size_t n) {
    const Eigen::Vector3d x = kMillimetresPerMetre * held.split.mesh.rest_positions.col(static_cast<Eigen::Index>(n));
    return absl::StrCat(n + 1, ", ", number(x[0]), ", ", number(x[1]), ", ", number(x[2]), "\n");
  };
  sections.push_back({"*NODE, NSET=ALL\n", static_cast<size_t>(held.split.mesh.n_nodes()), line});
  add_node_set("SKIN", held.skin_nodes);
  add_node_set("BONE", held.split.bone_nodes);
}

void CalculixDeck::Content::add_elements() {
  for (size_t layer = 0; layer < layers.size(); ++layer) {
    const auto first = static_cast<size_t>(first_level[layer]) * hexahedra_a_layer_level;
    const auto last = static_cast<size_t>(first_level[layer + 1]) * hexahedra_a_layer_level;
    const auto line = [this, first](size_t k) {
      std::string text = absl::StrCat(first + k + 1);
      for (const int node : held.split.mesh.hexahedra[first + k]) absl::StrAppend(&text, ", ", node + 1);
      return text + "\n";
    };
    sections.push_back({absl::StrCat("*ELEMENT, TYPE=C3D8I, ELSET=", layer_set(layer), "\n"), last - first, line});
  }
}

namespace {

/// The card of a law: E and nu, or C10 = mu/2 and D1 = 2/kappa in MPa.
std::string write_law(const solid::ElasticMaterial& material) {
  const double E = material.youngs_modulus * kMegapascalsPerPascal;
  const double nu = material.poisson_ratio;
  if (material.law == solid::TissueLaw::kCorotational) return absl::StrCat("*ELASTIC\n", number(E), ", ", number(nu));
  const double mu = E / (2.0 * (1.0 + nu));
  const double kappa = E / (3.0 * (1.0 - 2.0 * nu));
  return absl::StrCat("*HYPERELASTIC, NEO HOOKE\n", number(0.5 * mu), ", ", number(2.0 / kappa));
}

}  // namespace

void CalculixDeck::Content::add_materials() {
  for (size_t layer = 0; layer < layers.size(); ++layer) {
    const std::string name = layer_set(layer);
    const solid::ElasticMaterial& material = layers[layer].material;
    add(absl::StrCat("*MATERIAL, NAME=", name, "\n", write_law(material), "\n*DENSITY\n",
                     number(material.density * kTonnesPerCubicMillimetrePerKilogramPerCubicMetre),
                     "\n*SOLID SECTION, ELSET=", name, ", MATERIAL=", name, "\n"));
  }
}

void CalculixDeck::Content::add_supports() {
  std::vector<bool> is_bone(held.supports.fixed.size(), false);
  for (const int node : held.split.bone_nodes) is_bone[node] = true;
  std::vector<int> fixed;
  std::array<std::vector<int>, 3> rollers;
  for (size_t n = 0; n < held.supports.fixed.size(); ++n) {
    const std::array<bool, 3>& held_axes = held.supports.fixed[n];
    if (is_bone[n]) continue;
    const bool all = held_axes[0] && held_axes[1] && held_axes[2];
    if (all) fixed.push_back(static_cast<int>(n));
    for (int c = 0; c < 3 && !all; ++c) {
      if (held_axes[c]) rollers[c].push_back(static_cast<int>(n));
    }
  }
  std::string cards;
  if (!fixed.empty()) cards = "*BOUNDARY\nFIXED, 1, 3\n";
  add_node_set("FIXED", std::move(fixed));
  for (int c = 0; c < 3; ++c) {
    if (!rollers[c].empty()) absl::StrAppend(&cards, "*BOUNDARY\nHELD_", kAxis[c], ", ", c + 1, ", ", c + 1, "\n");
    add_node_set(absl::StrCat("HELD_", kAxis[c]), std::move(rollers[c]));
  }
  if (!cards.empty()) add(std::move(cards));
}

void CalculixDeck::Content::add_springs() {
  const solid::NodeSupports& supports = held.supports;
  std::map<double, std::vector<int>> nodes_of_stiffness;
  for (size_t n = 0; n < supports.spring.size(); ++n) {
    if (supports.spring[n] > 0.0) nodes_of_stiffness[supports.spring[n]].push_back(static_cast<int>(n));
  }
  int group = 0;
  for (const auto& [stiffness, nodes] : nodes_of_stiffness) {
    ++group;
    for (int c = 0; c < 3; ++c) {
      std::vector<std::string> ends;
      for (const int node : nodes) {
        if (!supports.fixed[node][c]) ends.push_back(absl::StrCat(node + 1));
      }
      add_spring_set("SPRING1", absl::StrCat("SUPPORT", group, "_", kAxis[c]), absl::StrCat(c + 1), stiffness,
                     std::move(ends));
    }
  }
  add_attachments();
}

/// A spring a direction between the two walls at each place where an attachment holds them.
void CalculixDeck::Content::add_attachments() {
  for (size_t k = 0; k < attachments.size(); ++k) {
    const Attachment& attachment = attachments[k];
    for (int c = 0; c < 3; ++c) {
      add_spring_set("SPRING2", absl::StrCat("ATTACHMENT", k + 1, "_", kAxis[c]), absl::StrCat(c + 1, ", ", c + 1),
                     attachment.stiffness, {absl::StrCat(attachment.outer + 1, ", ", attachment.inner + 1)});
    }
  }
}

/// @param ends  the nodes of each spring
void CalculixDeck::Content::add_spring_set(const char* type, const std::string& set, const std::string& directions,
                                           double stiffness, std::vector<std::string> ends) {
  if (ends.empty()) return;
  const size_t first = held.split.mesh.n_hexahedra() + n_springs + 1;
  n_springs += ends.size();
  const size_t n_ends = ends.size();
  sections.push_back(
      {absl::StrCat("*ELEMENT, TYPE=", type, ", ELSET=", set, "\n"), n_ends,
       [ends = std::move(ends), first](size_t k) { return absl::StrCat(first + k, ", ", ends[k], "\n"); }});
  add(absl::StrCat("*SPRING, ELSET=", set, "\n", directions, "\n",
                   number(stiffness * kNewtonsPerMillimetrePerNewtonPerMetre), "\n"));
}

void CalculixDeck::Content::add_surface(const std::string& name, const std::vector<LoadedFace>& faces) {
  if (faces.empty()) return;
  sections.push_back({absl::StrCat("*SURFACE, NAME=", name, ", TYPE=ELEMENT\n"), faces.size(),
                      [&faces](size_t k) { return absl::StrCat(faces[k].element, ", S", faces[k].face, "\n"); }});
}

void CalculixDeck::Content::add_loads() {
  for (const FilmWalls& film : films) {
    for (const std::vector<LoadedFace>* wall : {&film.outer, &film.inner}) {
      if (wall->empty()) continue;
      const auto line = [wall](size_t k) {
        const LoadedFace& face = (*wall)[k];
        return absl::StrCat(face.element, ", P", face.face, ", ", number(face.pressure * kMegapascalsPerPascal), "\n");
      };
      sections.push_back({absl::StrCat("** ", film.name, "\n*DLOAD\n"), wall->size(), line});
    }
  }
  if (gravity.norm() == 0.0) return;
  std::string cards = "*DLOAD\n";
  const Eigen::Vector3d direction = gravity.normalized();
  for (size_t layer = 0; layer < layers.size(); ++layer) {
    absl::StrAppend(&cards, layer_set(layer), ", GRAV, ", number(gravity.norm() * kMillimetresPerMetre), ", ",
                    number(direction[0]), ", ", number(direction[1]), ", ", number(direction[2]), "\n");
  }
  add(std::move(cards));
}

void CalculixDeck::Content::add_step() {
  for (const FilmWalls& film : films) {
    add_surface(film.name + "_OUTER", film.outer);
    add_surface(film.name + "_INNER", film.inner);
  }
  add("*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1.0, 1e-5, 0.25\n");
  add_loads();
  add("*NODE PRINT, NSET=SKIN, FREQUENCY=1000\nU\n*NODE FILE, FREQUENCY=1000\nU\n*EL FILE, FREQUENCY=1000\nS, E\n"
      "*END STEP\n");
}

CalculixDeck::CalculixDeck(std::unique_ptr<Content> content) : content_(std::move(content)) {}
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
  auto content = std::make_unique<Content>();
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
