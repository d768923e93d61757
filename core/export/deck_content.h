#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "core/mechanics/tissue_setup.h"
#include "core/model/face_model.h"

namespace lipofill::exporting {

/// Makes a name of the plan a part of a set's name: letters, digits and underscores.
std::string safe_name(const std::string& name);
/// Names a set: its kind, its number counted from 1, and a name of the plan.
std::string set_name(const char* kind, size_t index, const std::string& name);

/// A face of a hexahedron under pressure; both numbered from 1.
struct LoadedFace {
  int element = 0;
  int face = 0;
  double pressure = 0.0;  ///< [Pa]
};

/// The walls of one film.
struct FilmWalls {
  std::string name;
  std::vector<LoadedFace> outer;
  std::vector<LoadedFace> inner;  ///< empty where the film lies on bone
};

/// Two nodes that the edge of a zone holds together (plan/zone_bond.h).
struct Attachment {
  int outer = 0;
  int inner = 0;
  double stiffness = 0.0;  ///< [N/m]
};

/// A part of the deck: a head of one or more lines, and lines that are made when they are read.
struct Section {
  std::string head;
  size_t n_lines = 0;
  std::function<std::string(size_t)> line;
};

/// These are the cards of a deck (calculix_deck.h). The content owns what the lines are made from,
/// so that the sections may refer to it; it is not moved once there is one.
struct DeckContent {
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

}  // namespace lipofill::exporting
