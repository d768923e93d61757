#include "core/export/deck_content.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/units.h"

namespace lipofill::exporting {
namespace {

constexpr size_t kNumbersALine = 10;
constexpr std::array<const char*, 3> kAxis = {"X", "Y", "Z"};

/// A number as wide as CalculiX reads: 20 characters.
std::string number(double value) {
  return absl::StrFormat("%.12e", value);
}

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

void DeckContent::add_node_set(const std::string& name, std::vector<int> nodes) {
  if (nodes.empty()) return;
  const size_t n_lines = (nodes.size() + kNumbersALine - 1) / kNumbersALine;
  sections.push_back({absl::StrCat("*NSET, NSET=", name, "\n"), n_lines, [nodes = std::move(nodes)](size_t line) {
                        std::string text;
                        const size_t end = std::min(nodes.size(), (line + 1) * kNumbersALine);
                        for (size_t k = line * kNumbersALine; k < end; ++k) absl::StrAppend(&text, nodes[k] + 1, ",");
                        return text + "\n";
                      }});
}

void DeckContent::add_nodes() {
  const auto line = [this](size_t n) {
    const Eigen::Vector3d x = kMillimetresPerMetre * held.split.mesh.rest_positions.col(static_cast<Eigen::Index>(n));
    return absl::StrCat(n + 1, ", ", number(x[0]), ", ", number(x[1]), ", ", number(x[2]), "\n");
  };
  sections.push_back({"*NODE, NSET=ALL\n", static_cast<size_t>(held.split.mesh.n_nodes()), line});
  add_node_set("SKIN", held.skin_nodes);
  add_node_set("BONE", held.split.bone_nodes);
}

void DeckContent::add_elements() {
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

void DeckContent::add_materials() {
  for (size_t layer = 0; layer < layers.size(); ++layer) {
    const std::string name = layer_set(layer);
    const solid::ElasticMaterial& material = layers[layer].material;
    add(absl::StrCat("*MATERIAL, NAME=", name, "\n", write_law(material), "\n*DENSITY\n",
                     number(material.density * kTonnesPerCubicMillimetrePerKilogramPerCubicMetre),
                     "\n*SOLID SECTION, ELSET=", name, ", MATERIAL=", name, "\n"));
  }
}

void DeckContent::add_supports() {
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

void DeckContent::add_springs() {
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
void DeckContent::add_attachments() {
  for (size_t k = 0; k < attachments.size(); ++k) {
    const Attachment& attachment = attachments[k];
    for (int c = 0; c < 3; ++c) {
      add_spring_set("SPRING2", absl::StrCat("ATTACHMENT", k + 1, "_", kAxis[c]), absl::StrCat(c + 1, ", ", c + 1),
                     attachment.stiffness, {absl::StrCat(attachment.outer + 1, ", ", attachment.inner + 1)});
    }
  }
}

/// @param ends  the nodes of each spring
void DeckContent::add_spring_set(const char* type, const std::string& set, const std::string& directions,
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

void DeckContent::add_surface(const std::string& name, const std::vector<LoadedFace>& faces) {
  if (faces.empty()) return;
  sections.push_back({absl::StrCat("*SURFACE, NAME=", name, ", TYPE=ELEMENT\n"), faces.size(),
                      [&faces](size_t k) { return absl::StrCat(faces[k].element, ", S", faces[k].face, "\n"); }});
}

void DeckContent::add_loads() {
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

void DeckContent::add_step() {
  for (const FilmWalls& film : films) {
    add_surface(film.name + "_OUTER", film.outer);
    add_surface(film.name + "_INNER", film.inner);
  }
  add("*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1.0, 1e-5, 0.25\n");
  add_loads();
  add("*NODE PRINT, NSET=SKIN, FREQUENCY=1000\nU\n*NODE FILE, FREQUENCY=1000\nU\n*EL FILE, FREQUENCY=1000\nS, E\n"
      "*END STEP\n");
}

}  // namespace lipofill::exporting
