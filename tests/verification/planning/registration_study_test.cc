// Scans in random poses, 30 % of each cut away, are registered to the whole face without landmarks.
// How far every vertex comes from where it was is known, so that what is wrong is known, and
// whether it was said. Faces of other people must be refused.
//
// LIPOFILL_EVERY_POSE=1 (deploy/poses) takes 20 poses of every face and every pair of different
// faces, which takes some ten minutes; without it a few of each. LIPOFILL_FACE, a regular
// expression, chooses faces. Poses and cuts are drawn with a seed for each face and pose.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <regex>
#include <string>
#include <vector>

#include "core/base/units.h"
#include "core/geometry/surface_topology.h"
#include "core/planning/registration.h"
#include "tests/integration/faces/face_files.h"

namespace lipofill::planning {
namespace {

using testing::FaceFile;

constexpr double kWithin = 0.5e-3;  // [m]
constexpr double kCutAway = 0.3;

bool is_whole_study() {
  return std::getenv("LIPOFILL_EVERY_POSE") != nullptr;
}

std::vector<FaceFile> choose_faces(size_t most) {
  std::vector<FaceFile> faces = testing::find_face_files(LIPOFILL_SHARED_DATA "/faces");
  if (const char* pattern = std::getenv("LIPOFILL_FACE")) {
    std::erase_if(faces, [&](const FaceFile& face) { return !std::regex_search(face.stem, std::regex(pattern)); });
  }
  // Heads come before masks: some of each.
  if (is_whole_study() || faces.size() <= most) return faces;
  std::vector<FaceFile> some;
  for (size_t k = 0; k < most; ++k) some.push_back(faces[k * (faces.size() - 1) / (most - 1)]);
  return some;
}

class Dice {
 public:
  explicit Dice(uint64_t seed) : engine_(seed) {}
  /// In [0, 1); the library's distributions differ between libraries.
  double draw() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double draw_normal() { return std::sqrt(-2.0 * std::log(1.0 - draw())) * std::cos(2.0 * std::numbers::pi * draw()); }
  Eigen::Vector3d draw_vector() {
    const double x = draw_normal(), y = draw_normal(), z = draw_normal();
    return {x, y, z};
  }
  /// Any rotation as likely as any other, and a shift of some 300 mm.
  RigidMotion draw_pose() {
    const Eigen::Vector3d v = draw_vector();
    return {Eigen::Quaterniond(draw_normal(), v[0], v[1], v[2]).normalized().toRotationMatrix(), 0.2 * draw_vector()};
  }

 private:
  std::mt19937_64 engine_;
};

/// Takes away 30 % of the triangles: those beyond a plane in a random direction, or those nearest
/// to a random place of the surface.
geometry::SurfaceMesh cut_away(const geometry::SurfaceMesh& scan, Dice& dice) {
  const bool by_plane = dice.draw() < 0.5;
  const Eigen::Vector3d direction = dice.draw_vector().normalized();
  const Eigen::Vector3d place = scan.points.col(static_cast<Eigen::Index>(dice.draw() * scan.n_vertices()));
  std::vector<double> order;
  for (const auto& t : scan.triangles) {
    const Eigen::Vector3d middle = (scan.points.col(t[0]) + scan.points.col(t[1]) + scan.points.col(t[2])) / 3.0;
    order.push_back(by_plane ? direction.dot(middle) : (middle - place).norm());
  }
  std::vector<double> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  const double bar = sorted[static_cast<size_t>(kCutAway * static_cast<double>(sorted.size()))];
  std::vector<int> kept;
  for (size_t t = 0; t < order.size(); ++t) {
    if (order[t] >= bar) kept.push_back(static_cast<int>(t));
  }
  return geometry::extract_triangles(scan, kept).mesh;
}

geometry::SurfaceMesh move_surface(geometry::SurfaceMesh mesh, const RigidMotion& motion) {
  for (int v = 0; v < mesh.n_vertices(); ++v) mesh.points.col(v) = motion.apply(mesh.points.col(v)).eval();
  return mesh;
}

/// What came of one registration.
struct Outcome {
  double error = 0.0;  ///< the farthest vertex is so far from where it was [m]
  bool is_refused = false;
  Registration registration;

  bool is_good() const { return !is_refused && error <= kWithin; }
  bool is_silently_wrong() const { return !is_refused && error > kWithin; }
};

Outcome register_part(const SkinSurface& face, const geometry::SurfaceMesh& scan, uint64_t seed) {
  Dice dice(seed);
  const RigidMotion pose = dice.draw_pose();
  const geometry::SurfaceMesh part = cut_away(scan, dice);
  const SkinSurface moving = *extract_skin(move_surface(part, pose), "the part");
  Outcome outcome;
  outcome.registration = *register_surface({moving, face, {}, {}});
  outcome.is_refused = !check_registration(outcome.registration, "the part").ok();
  const RigidMotion whole = outcome.registration.motion.after(pose);
  for (int v = 0; v < part.n_vertices(); ++v) {
    outcome.error = std::max(outcome.error, (whole.apply(part.points.col(v)) - part.points.col(v)).norm());
  }
  return outcome;
}

void print(const std::string& what, const Outcome& o) {
  const Registration& r = o.registration;
  std::printf("%s: off by %.4f mm, overlap %.3f, within 1 mm %.3f, known to %.3f mm, rival %.2f, confidence %.2f%s\n",
              what.c_str(), o.error * kMillimetresPerMetre, r.overlap, r.share_within_1_mm,
              r.expected_error * kMillimetresPerMetre, r.rival, r.confidence,
              o.is_silently_wrong() ? ", SILENTLY WRONG" : (o.is_refused ? ", refused" : ""));
  std::fflush(stdout);
}

TEST(RegistrationStudy, FindsFacesInRandomPoses) {
  const std::vector<FaceFile> faces = choose_faces(3);
  if (faces.empty()) GTEST_SKIP() << "no faces in " << LIPOFILL_SHARED_DATA;
  const int poses = is_whole_study() ? 20 : 2;
  int all = 0, good = 0, silent = 0;
  double worst = 0.0;
  for (size_t f = 0; f < faces.size(); ++f) {
    const geometry::SurfaceMesh scan = testing::read_face_file(faces[f]).scan;
    const SkinSurface face = *extract_skin(scan, "the face");
    for (int p = 0; p < poses; ++p) {
      const Outcome outcome = register_part(face, scan, 1000 * f + static_cast<uint64_t>(p));
      print(faces[f].stem + " pose " + std::to_string(p), outcome);
      ++all;
      good += outcome.is_good();
      silent += outcome.is_silently_wrong();
      if (outcome.is_good()) worst = std::max(worst, outcome.error);
    }
  }
  std::printf("%d of %d within %.1f mm (the worst of them %.4f mm), %d silently wrong\n", good, all,
              kWithin * kMillimetresPerMetre, worst * kMillimetresPerMetre, silent);
  EXPECT_GE(good, 0.99 * all);
  EXPECT_EQ(silent, 0);
}

TEST(RegistrationStudy, RefusesFacesOfOthers) {
  const std::vector<FaceFile> faces = choose_faces(3);
  if (faces.size() < 2) GTEST_SKIP() << "no two faces in " << LIPOFILL_SHARED_DATA;
  double most = 0.0;
  for (size_t a = 0; a < faces.size(); ++a) {
    const SkinSurface face = *extract_skin(testing::read_face_file(faces[a]).scan, "the face");
    const size_t last = is_whole_study() ? faces.size() - 1 : 1;
    for (size_t k = 1; k <= last; ++k) {
      const FaceFile& other = faces[(a + k) % faces.size()];
      const Outcome outcome = register_part(face, testing::read_face_file(other).scan, a * 100 + k);
      print(other.stem + " on " + faces[a].stem, outcome);
      EXPECT_TRUE(outcome.is_refused) << other.stem << " on " << faces[a].stem;
      most = std::max(most, outcome.registration.share_within_1_mm);
    }
  }
  std::printf("of another face at most %.3f fit within 1 mm; needed are %.2f\n", most, kShareBounds.refused);
}

}  // namespace
}  // namespace lipofill::planning
