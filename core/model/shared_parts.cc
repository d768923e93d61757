#include "core/model/shared_parts.h"

#include "core/base/hash.h"
#include "core/model/face_model.h"

namespace lipofill::model {
namespace {

template <typename T, size_t N>
void add(Hasher& hasher, const std::vector<std::array<T, N>>& tuples) {
  hasher.add(static_cast<uint64_t>(tuples.size()));
  hasher.add_bytes(tuples.data(), tuples.size() * sizeof(std::array<T, N>));
}

void add_matrix(Hasher& hasher, const Eigen::Matrix3Xd& matrix) {
  hasher.add(static_cast<uint64_t>(matrix.cols()));
  hasher.add_bytes(matrix.data(), static_cast<size_t>(matrix.size()) * sizeof(double));
}

/// Young's modulus is left out: it belongs to the tissue, not to its structure.
void add(Hasher& hasher, const solid::ElasticMaterial& material) {
  for (const double value : {material.poisson_ratio, material.density, material.prestress}) {
    hasher.add(value);
  }
  hasher.add(static_cast<int>(material.law));
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

std::string key_of_pattern(const solid::HexMesh& mesh, const solid::NodeSupports& supports,
                           const std::vector<solid::WallSpring>& springs) {
  Hasher hasher;
  hasher.add(static_cast<uint64_t>(mesh.rest_positions.cols()));
  add(hasher, mesh.hexahedra);
  add(hasher, supports.fixed);
  for (const solid::WallSpring& spring : springs) {
    hasher.add_bytes(spring.outer.data(), sizeof spring.outer);
    hasher.add_bytes(spring.inner.data(), sizeof spring.inner);
  }
  return hasher.hex_digest();
}

std::string key_of_tissue(const std::string& pattern_key, const solid::HexMesh& mesh,
                          const std::vector<solid::ElasticMaterial>& materials, const solid::NodeSupports& supports,
                          const std::vector<solid::WallSpring>& springs) {
  Hasher hasher;
  hasher.add(pattern_key);
  add_matrix(hasher, mesh.rest_positions);
  hasher.add(mesh.material);
  hasher.add(std::vector<char>(mesh.stacked.begin(), mesh.stacked.end()));
  hasher.add(static_cast<uint64_t>(materials.size()));
  for (const solid::ElasticMaterial& material : materials) add(hasher, material);
  hasher.add(supports.spring);
  for (const solid::WallSpring& spring : springs) add(hasher, spring);
  return hasher.hex_digest();
}

std::string key_of_gap(const std::string& pattern_key, const geometry::LayeredGrid& grid,
                       const coupling::WallNodes& walls, const film::FilmGrid& film,
                       const std::vector<film::CellPiece>& pieces) {
  Hasher hasher;
  hasher.add(pattern_key);
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

std::string key_of_analysis(const std::string& pattern_key, const std::vector<std::string>& gap_keys,
                            bool has_pressures) {
  Hasher hasher;
  hasher.add(pattern_key);
  for (const std::string& key : gap_keys) hasher.add(key);
  hasher.add(has_pressures);
  return hasher.hex_digest();
}

}  // namespace lipofill::model
