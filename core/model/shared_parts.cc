#include "core/model/shared_parts.h"

#include "core/base/hash.h"
#include "core/model/face_model.h"

namespace lipofill::model {
namespace {

template <size_t N>
void add(Hasher& hasher, const std::vector<std::array<int, N>>& tuples) {
  hasher.add(static_cast<uint64_t>(tuples.size()));
  hasher.add_bytes(tuples.data(), tuples.size() * sizeof(std::array<int, N>));
}

void add(Hasher& hasher, const solid::HexMesh& mesh) {
  hasher.add(static_cast<uint64_t>(mesh.rest_positions.cols()));
  hasher.add_bytes(mesh.rest_positions.data(), static_cast<size_t>(mesh.rest_positions.size()) * sizeof(double));
  add(hasher, mesh.hexahedra);
  hasher.add(mesh.material);
  for (const bool stacked : mesh.stacked) hasher.add(stacked);
}

/// Young's modulus is left out: it belongs to the tissue, not to its structure.
void add(Hasher& hasher, const solid::ElasticMaterial& material) {
  for (const double value : {material.poisson_ratio, material.density, material.prestress}) {
    hasher.add(value);
  }
}

void add(Hasher& hasher, const solid::NodeSupports& supports) {
  hasher.add(static_cast<uint64_t>(supports.fixed.size()));
  for (const auto& fixed : supports.fixed) {
    for (const bool component : fixed) hasher.add(component);
  }
  hasher.add(supports.spring);
}

void add(Hasher& hasher, const solid::WallSpring& spring) {
  hasher.add_bytes(spring.outer.data(), sizeof spring.outer);
  hasher.add_bytes(spring.inner.data(), sizeof spring.inner);
  hasher.add_bytes(spring.weight.data(), sizeof spring.weight);
  hasher.add(spring.stiffness);
  hasher.add(spring.slack);
}

}  // namespace

std::shared_ptr<SharedParts> make_shared_parts() {
  return std::make_shared<SharedParts>();
}

std::string key_of_tissue(const solid::HexMesh& mesh, const std::vector<solid::ElasticMaterial>& materials,
                          const solid::NodeSupports& supports, const std::vector<solid::WallSpring>& springs) {
  Hasher hasher;
  add(hasher, mesh);
  hasher.add(static_cast<uint64_t>(materials.size()));
  for (const solid::ElasticMaterial& material : materials) add(hasher, material);
  add(hasher, supports);
  for (const solid::WallSpring& spring : springs) add(hasher, spring);
  return hasher.hex_digest();
}

std::string key_of_gap(const std::string& tissue_key, const geometry::LayeredGrid& grid,
                       const coupling::WallNodes& walls, const film::FilmGrid& film,
                       const std::vector<film::CellPiece>& pieces) {
  Hasher hasher;
  hasher.add(tissue_key);
  hasher.add(grid.n_xi);
  hasher.add(grid.n_eta);
  hasher.add(walls.outer);
  hasher.add(walls.inner);
  for (const double bound : {film.extent.xi_min, film.extent.xi_max, film.extent.eta_min, film.extent.eta_max}) {
    hasher.add(bound);
  }
  hasher.add(film.n_xi);
  hasher.add(film.n_eta);
  hasher.add(film.slot_of_cell);
  for (const film::CellPiece& piece : pieces) {
    for (const int place : {piece.cell, piece.quad_i, piece.quad_j}) hasher.add(place);
    for (const double share : piece.share) hasher.add(share);
  }
  return hasher.hex_digest();
}

std::string key_of_analysis(const std::string& tissue_key, const std::vector<std::string>& gap_keys,
                            bool has_pressures) {
  Hasher hasher;
  hasher.add(tissue_key);
  for (const std::string& key : gap_keys) hasher.add(key);
  hasher.add(has_pressures);
  return hasher.hex_digest();
}

}  // namespace lipofill::model
