#include "core/geometry/surface_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <sstream>

#include "core/geometry/ply_writer.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

using ::testing::HasSubstr;

const char kTetrahedronObj[] =
    "# a comment\r\nmtllib x.mtl\no part\n"
    "v 0 0 0\nv 100 0 0 1.0\nv 0 +100 0\nv 0 0 1e2\nvt 0 0\nvn 0 0 1\ng side\nusemtl skin\ns off\n"
    "f 1/1 3/1 2/1\nf 1//1 2//1 4//1\nf -4/1/1 -1/1/1 -2/1/1\nf 2 3 4";

std::string to_obj(const SurfaceMesh& mesh) {
  std::ostringstream out;
  out.precision(9);
  for (int v = 0; v < mesh.n_vertices(); ++v) out << "v " << 1e3 * mesh.points.col(v).transpose() << "\n";
  for (const auto& [a, b, c] : mesh.triangles) out << "f " << a + 1 << " " << b + 1 << " " << c + 1 << "\n";
  return out.str();
}

std::string to_ascii_ply(const SurfaceMesh& mesh) {
  std::ostringstream out;
  out.precision(9);
  out << "ply\nformat ascii 1.0\ncomment made for a test\nelement vertex " << mesh.n_vertices()
      << "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nelement face "
      << mesh.n_triangles() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int v = 0; v < mesh.n_vertices(); ++v) out << 1e3 * mesh.points.col(v).transpose() << " 200\n";
  for (const auto& [a, b, c] : mesh.triangles) out << "3 " << a << " " << b << " " << c << "\n";
  return out.str();
}

template <typename T>
void append(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big_endian) std::reverse(raw, raw + sizeof raw);
  bytes.append(raw, sizeof raw);
}

std::string to_binary_ply(const SurfaceMesh& mesh, bool big_endian) {
  std::ostringstream header;
  header
      << "ply\nformat binary_" << (big_endian ? "big" : "little") << "_endian 1.0\nelement vertex " << mesh.n_vertices()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement extra 1\nproperty list uint8 int16 ignored\n"
      << "element face " << mesh.n_triangles()
      << "\nproperty uchar flag\nproperty list uchar uint vertex_index\nend_header\n";
  std::string bytes = header.str();
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    for (int c = 0; c < 3; ++c) append(bytes, static_cast<float>(1e3 * mesh.points(c, v)), big_endian);
  }
  append(bytes, uint8_t{1}, big_endian);
  append(bytes, int16_t{7}, big_endian);
  for (const auto& triangle : mesh.triangles) {
    append(bytes, uint8_t{0}, big_endian);
    append(bytes, uint8_t{3}, big_endian);
    for (const int v : triangle) append(bytes, static_cast<uint32_t>(v), big_endian);
  }
  return bytes;
}

std::string to_binary_stl(const SurfaceMesh& mesh) {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // a trap some writers set
  append(bytes, static_cast<uint32_t>(mesh.n_triangles()), false);
  for (const auto& triangle : mesh.triangles) {
    for (int c = 0; c < 3; ++c) append(bytes, 0.0f, false);
    for (const int v : triangle) {
      for (int c = 0; c < 3; ++c) append(bytes, static_cast<float>(1e3 * mesh.points(c, v)), false);
    }
    append(bytes, uint16_t{0}, false);
  }
  return bytes;
}

std::string to_ascii_stl(const SurfaceMesh& mesh) {
  std::ostringstream out;
  out.precision(9);
  out << "solid made for a test\n";
  for (const auto& triangle : mesh.triangles) {
    out << "facet normal 0 0 0\n outer loop\n";
    for (const int v : triangle) out << "  vertex " << 1e3 * mesh.points.col(v).transpose() << "\n";
    out << " endloop\nendfacet\n";
  }
  out << "endsolid made for a test\n";
  return out.str();
}

struct Sample {
  const char* name;
  SurfaceFormat format;
  std::string bytes;
};

std::vector<Sample> make_samples() {
  const SurfaceMesh cap = make_sphere_cap(0.08, 1.0, 4);
  return {{"obj", SurfaceFormat::kObj, to_obj(cap)},
          {"obj with everything", SurfaceFormat::kObj, kTetrahedronObj},
          {"ascii ply", SurfaceFormat::kPly, to_ascii_ply(cap)},
          {"little-endian ply", SurfaceFormat::kPly, to_binary_ply(cap, false)},
          {"big-endian ply", SurfaceFormat::kPly, to_binary_ply(cap, true)},
          {"binary stl", SurfaceFormat::kStl, to_binary_stl(cap)},
          {"ascii stl", SurfaceFormat::kStl, to_ascii_stl(cap)}};
}

void expect_sound(const SurfaceMesh& mesh) {
  EXPECT_TRUE(mesh.points.allFinite());
  EXPECT_FALSE(mesh.triangles.empty());
  for (const auto& triangle : mesh.triangles) {
    for (const int v : triangle) {
      ASSERT_GE(v, 0);
      ASSERT_LT(v, mesh.n_vertices());
    }
  }
}

TEST(SurfaceReader, ReadsEveryFormatBackVertexForVertex) {
  const SurfaceMesh cap = make_sphere_cap(0.08, 1.0, 4);
  for (const Sample& sample : make_samples()) {
    if (sample.bytes == kTetrahedronObj || sample.format == SurfaceFormat::kStl) continue;
    const auto mesh = read_surface(sample.bytes, sample.format, 1e-3);
    ASSERT_TRUE(mesh.ok()) << sample.name << ": " << mesh.status();
    EXPECT_EQ(mesh->triangles, cap.triangles) << sample.name;
    EXPECT_LT((mesh->points - cap.points).cwiseAbs().maxCoeff(), 1e-8) << sample.name;
  }
}

TEST(SurfaceReader, ReadsObjCornersOfEveryKind) {
  const auto mesh = read_surface(kTetrahedronObj, SurfaceFormat::kObj, 1e-3);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  const std::vector<std::array<int, 3>> expected = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_EQ(mesh->triangles, expected);
  EXPECT_DOUBLE_EQ(mesh->points(1, 2), 0.1);
}

TEST(SurfaceReader, CutsConvexPolygonsIntoFans) {
  const auto mesh =
      read_surface("v 0 0 0\nv 50 0 0\nv 60 40 0\nv 25 70 0\nv -10 40 0\nf 1 2 3 4 5\n", SurfaceFormat::kObj, 1e-3);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  const std::vector<std::array<int, 3>> expected = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(mesh->triangles, expected);
}

TEST(SurfaceReader, MergesEqualPointsOfStl) {
  const SurfaceMesh cap = make_sphere_cap(0.08, 1.0, 4);
  for (const std::string& bytes : {to_binary_stl(cap), to_ascii_stl(cap)}) {
    const auto mesh = read_surface(bytes, SurfaceFormat::kStl, 1e-3);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_EQ(mesh->n_vertices(), cap.n_vertices());
    EXPECT_EQ(mesh->n_triangles(), cap.n_triangles());
    EXPECT_EQ(check_surface(*mesh).boundary_loops, 1);
    EXPECT_LT((mesh->points.col(0) - cap.points.col(0)).norm(), 1e-8);
  }
}

struct BadFile {
  SurfaceFormat format;
  std::string bytes;
  const char* complaint;
};

TEST(SurfaceReader, SaysWhatIsWrongAndWhere) {
  const std::string ply = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string three = "v 0 0 0\nv 99 0 0\nv 0 99 0\n";
  const std::vector<BadFile> files = {
      {SurfaceFormat::kObj, "", "empty"},
      {SurfaceFormat::kPly, "", "empty"},
      {SurfaceFormat::kStl, "", "empty"},
      {SurfaceFormat::kObj, "v 0 0 0\n", "no face"},
      {SurfaceFormat::kObj, three + "v 0 nan 0\nf 1 2 4\n", "line 4: a face has a corner at this vertex"},
      {SurfaceFormat::kObj, three + "v 0 1e999 0\nf 1 2 4\n", "coordinate inf is not a finite number"},
      {SurfaceFormat::kObj, "v 0 5mm 0\n", "line 1: vertex coordinate '5mm'"},
      {SurfaceFormat::kObj, three, "3 vertices and no face"},
      {SurfaceFormat::kObj, "v 0 0\n", "line 1: vertex coordinate ''"},
      {SurfaceFormat::kObj, three + "f 1 2 9\n", "must be in [0, 3)"},
      {SurfaceFormat::kObj, three + "f 1 2 0\n", "line 4: face corner '0'"},
      {SurfaceFormat::kObj, three + "f 1 2 -4\n", "line 4: face corner '-4'"},
      {SurfaceFormat::kObj, three + "f 1 2 99999999999999999999\n", "line 4"},
      {SurfaceFormat::kObj, three + "f 1 2 4294967297\n", "line 4"},
      {SurfaceFormat::kObj, three + "f 1 2\n", "only 1 face of fewer than 3 corners"},
      {SurfaceFormat::kObj, three + "f 1 2 x\n", "'x'"},
      {SurfaceFormat::kObj, ply + "element vertex 3\n", "line 1: 'ply' is no statement"},
      {SurfaceFormat::kObj,
       std::string("\x7f"
                   "ELF\x02\x01\x01\0\0\0",
                   10),
       "line 1"},
      {SurfaceFormat::kPly, three, "does not start with 'ply'"},
      {SurfaceFormat::kPly, ply, "no end_header"},
      {SurfaceFormat::kPly, "ply\nend_header\n", "without a format"},
      {SurfaceFormat::kPly, "ply\nformat binary_middle_endian 1.0\n", "line 2"},
      {SurfaceFormat::kPly, ply + "element vertex -1\n", "'-1'"},
      {SurfaceFormat::kPly, ply + "element vertex 4000000000\n" + xyz + "end_header\n0 0 0\n", "4000000000"},
      {SurfaceFormat::kPly, ply + "element vertex 9223372036854775807\n" + xyz + "end_header\n", "9223372036854775807"},
      {SurfaceFormat::kPly, ply + "element vertex 9223372036854775807\nend_header\n", "no properties"},
      {SurfaceFormat::kPly, ply + "property float x\n", "before any element"},
      {SurfaceFormat::kPly, ply + "element vertex 1\nproperty quad x\n", "'quad'"},
      {SurfaceFormat::kPly, ply + "element vertex 1\nproperty list float int x\n", "'float'"},
      {SurfaceFormat::kPly, ply + "element vertex 1\nproperty float x\nend_header\n0 0 0\n", "x, y and z"},
      {SurfaceFormat::kPly, ply + "element vertex 1\n" + xyz + face + "0 0 nan\n3 0 0 0\n", "coordinate nan"},
      {SurfaceFormat::kPly, ply + "element vertex 1\n" + xyz + face + "0 0 x\n3 0 0 0\n", "'x' is not a number"},
      {SurfaceFormat::kPly, ply + "element vertex 1\n" + xyz + face + "0 0 0\n3 0 0 7\n", "vertex 7"},
      {SurfaceFormat::kPly, ply + "element vertex 1\n" + xyz + face + "0 0 0\n3 0 0 -1\n", "vertex -1"},
      {SurfaceFormat::kPly, ply + "element vertex 1\n" + xyz + face + "0 0 0\n4000000 0 0 0\n", "list of 4e+06 items"},
      {SurfaceFormat::kPly, ply + "element vertex 1\n" + xyz + face + "0 0 0\n3 0 0 0.5\n", "not a whole number"},
      {SurfaceFormat::kPly, ply + "element vertex 1\n" + xyz + face + "0 0 0\n3 0 0 \n", "ends inside"},
      {SurfaceFormat::kStl, three, "does not start with 'solid'"},
      {SurfaceFormat::kStl, std::string(200, 'x'), "promises"},
      {SurfaceFormat::kStl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n", "line 4"},
      {SurfaceFormat::kStl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "'vertex' is due"},
      {SurfaceFormat::kStl, "solid a\nbanana\n", "'banana'"},
      {SurfaceFormat::kStl, "solid a\n", "without 'endsolid'"},
      {SurfaceFormat::kStl, "solid a\nendsolid a\n", "no face"},
  };
  for (const BadFile& file : files) {
    const auto mesh = read_surface(file.bytes, file.format, 1e-3);
    ASSERT_FALSE(mesh.ok()) << file.bytes;
    EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(mesh.status().message()), HasSubstr(file.complaint)) << file.bytes;
  }
}

TEST(SurfaceReader, HoldsItsLimits) {
  const std::string obj = to_obj(make_sphere_cap(0.08, 1.0, 4));
  const auto complaint = [&](double unit, SurfaceLimits limits) {
    const auto mesh = read_surface(obj, SurfaceFormat::kObj, unit, limits);
    return mesh.ok() ? std::string("accepted") : std::string(mesh.status().message());
  };
  EXPECT_EQ(complaint(1e-3, {}), "accepted");
  EXPECT_THAT(complaint(1.0, {}), HasSubstr("is the unit right"));
  EXPECT_THAT(complaint(1e-5, {}), HasSubstr("is the unit right"));
  EXPECT_THAT(complaint(0.0, {}), HasSubstr("must be above 0"));
  EXPECT_THAT(complaint(std::nan(""), {}), HasSubstr("must be above 0"));
  EXPECT_THAT(complaint(1e-3, {.max_bytes = 100}), HasSubstr("at most 100"));
  EXPECT_THAT(complaint(1e-3, {.max_vertices = 24}), HasSubstr("more than 24 vertices"));
  EXPECT_THAT(complaint(1e-3, {.max_triangles = 31}), HasSubstr("more than 31 triangles"));
}

TEST(SurfaceReader, TruncationNeverCrashesAndBinaryTruncationIsAlwaysSeen) {
  for (const Sample& sample : make_samples()) {
    for (size_t length = 0; length < sample.bytes.size(); ++length) {
      const auto mesh = read_surface(std::string_view(sample.bytes).substr(0, length), sample.format, 1e-3);
      if (mesh.ok()) expect_sound(*mesh);
      const bool must_fail = sample.format != SurfaceFormat::kObj && length + 30 < sample.bytes.size();
      EXPECT_FALSE(must_fail && mesh.ok()) << sample.name << " cut to " << length << " bytes";
      const bool binary = std::string_view(sample.name).find("endian") != std::string_view::npos ||
                          std::string_view(sample.name) == "binary stl";
      EXPECT_FALSE(binary && mesh.ok()) << sample.name << " cut to " << length << " bytes";
    }
  }
}

TEST(SurfaceReader, MutatedFilesNeverCrash) {
  int accepted = 0;
  int refused = 0;
  for (const Sample& sample : make_samples()) {
    std::mt19937 random(20101);
    for (int round = 0; round < 600; ++round) {
      std::string bytes = sample.bytes;
      const int n_changes = 1 + static_cast<int>(random() % 8);
      for (int k = 0; k < n_changes; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      const auto mesh = read_surface(bytes, sample.format, 1e-3);
      if (mesh.ok()) expect_sound(*mesh);
      mesh.ok() ? ++accepted : ++refused;
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_GT(refused, 1000);
}

TEST(SurfaceReader, ChecksASurface) {
  SurfaceMesh mesh = put_together(make_sphere_cap(0.05, 1.0, 3), make_sphere_cap(0.08, 1.0, 3));
  EXPECT_EQ(check_surface(mesh).components, 2);
  EXPECT_EQ(check_surface(mesh).boundary_loops, 2);
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(check_surface(mesh).degenerate_triangles, 1);
  mesh.triangles.push_back({0, 5, 9});
  mesh.triangles.push_back({0, 5, 10});
  EXPECT_GT(check_surface(mesh).non_manifold_edges, 0);
}

TEST(PlyWriter, IsReadBackToTheBit) {
  SurfaceMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0.1, 0.2 + 1e-17, 1.0 / 3.0, -0.07, 0, 1e-9, 0.3, 0.1, -0.0, 0.25, 0.125, M_PI / 10;
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  const auto read = read_surface(write_ply(mesh), SurfaceFormat::kPly, 1.0);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->points == mesh.points);
  EXPECT_EQ(read->triangles, mesh.triangles);
}

}  // namespace
}  // namespace lipofill::geometry
