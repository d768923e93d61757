// Files of the kinds that programs in the wild write and readers stumble over: each kind in every
// format it can occur in, made here, and the files of ../shared/data/reader_cases where they are.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "core/geometry/surface_reader.h"
#include "core/geometry/surface_topology.h"
#include "tests/unit/geometry/written_models.h"

namespace lipofill::geometry {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

double area_of(const SurfaceMesh& mesh) {
  double area = 0.0;
  for (const auto& triangle : mesh.triangles) area += 0.5e6 * compute_area_vector(mesh, triangle).norm();
  return area;
}

/// Volume by the divergence theorem, in mL: that of a closed surface that faces outwards is
/// positive.
double volume_of(const SurfaceMesh& mesh) {
  double volume = 0.0;
  for (const auto& t : mesh.triangles) {
    volume += 1e6 / 6.0 * compute_area_vector(mesh, t).dot(mesh.points.col(t[0]));
  }
  return volume;
}

ScannedSurface read(const std::string& bytes, SurfaceFormat format) {
  auto mesh = read_surface(bytes, format, 1e-3);
  EXPECT_TRUE(mesh.ok()) << mesh.status() << "\n" << bytes.substr(0, 400);
  return mesh.ok() ? *std::move(mesh) : ScannedSurface{};
}

ScannedSurface expect_cube(const std::string& bytes, SurfaceFormat format) {
  ScannedSurface mesh = read(bytes, format);
  EXPECT_EQ(mesh.n_vertices(), 8);
  EXPECT_EQ(mesh.n_triangles(), 12);
  EXPECT_NEAR(area_of(mesh), 60'000.0, 1e-6);
  EXPECT_NEAR(volume_of(mesh), 1000.0, 1e-6);
  const SurfaceCheck check = check_surface(mesh);
  EXPECT_EQ(check.components, 1);
  EXPECT_EQ(check.boundary_loops, 0);
  EXPECT_NEAR((check.extent - Eigen::Vector3d::Constant(0.1)).norm(), 0.0, 1e-9);
  return mesh;
}

constexpr char kMark[] = "\xEF\xBB\xBF";

TEST(SurfaceKinds, EveryEndOfLineAndAByteOrderMark) {
  for (const auto& [format, text] : in_text_formats(Model::cube())) {
    for (const char* end : {"\n", "\r\n", "\r"}) {
      for (const char* mark : {"", kMark}) {
        EXPECT_THAT(expect_cube(mark + absl::StrReplaceAll(text, {{"\n", end}}), format).remarks, IsEmpty());
      }
    }
  }
}

TEST(SurfaceKinds, HeadersOfBinaryPlyWithEveryEndOfLine) {
  Model model = Model::cube();
  model.vertices[0][0] = -49.99999999999909;  // its first byte in the file is 10, as a line feed
  double x = model.vertices[0][0];
  reinterpret_cast<char*>(&x)[0] = '\n';
  model.vertices[0][0] = x;
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string bytes = to_binary_ply<int32_t>(model, "int");
    const size_t body = bytes.find("end_header\n") + std::strlen("end_header\n");
    bytes = absl::StrReplaceAll(bytes.substr(0, body), {{"\n", end}}) + bytes.substr(body);
    const ScannedSurface mesh = read(bytes, SurfaceFormat::kPly);
    ASSERT_EQ(mesh.n_vertices(), 8);
    EXPECT_DOUBLE_EQ(mesh.points(0, 0), 1e-3 * x);
  }
}

TEST(SurfaceKinds, Utf16IsNamed) {
  const auto mesh = read_surface(std::string("\xFF\xFEv\0 \0", 6), SurfaceFormat::kObj, 1e-3);
  EXPECT_THAT(std::string(mesh.status().message()), HasSubstr("UTF-16"));
}

TEST(SurfaceKinds, ConcavePolygonsInEveryFormat) {
  Model wall;
  wall.vertices = {{200, 100, 0}, {100, 100, 0}, {100, 200, 0}, {0, 200, 0}, {0, 0, 0}, {200, 0, 0}};
  wall.faces = {{0, 1, 2, 3, 4, 5}};
  std::vector<Written> files = in_indexed_formats(wall);
  files.push_back({SurfaceFormat::kStl, to_text_stl(wall)});
  for (const auto& [format, bytes] : files) {
    const ScannedSurface mesh = read(bytes, format);
    EXPECT_EQ(mesh.n_triangles(), 4);
    EXPECT_NEAR(area_of(mesh), 30'000.0, 1e-6);
    for (const auto& triangle : mesh.triangles) EXPECT_GE(compute_area_vector(mesh, triangle).z(), 0.0);
  }
}

TEST(SurfaceKinds, QuadsOfACube) {
  Model model;
  for (const auto& side : kSides) model.faces.emplace_back(side.begin(), side.end());
  for (const auto& [format, bytes] : in_indexed_formats(model)) expect_cube(bytes, format);
}

TEST(SurfaceKinds, FacesThatCrossThemselvesAreRemarkedUpon) {
  Model model = Model::cube();
  model.faces.push_back({0, 1, 3, 2});
  for (const auto& [format, bytes] : in_indexed_formats(model)) {
    EXPECT_THAT(read(bytes, format).remarks, Contains(HasSubstr("1 face crosses itself")));
  }
}

TEST(SurfaceKinds, ShortFacesAreLeftOutWithARemark) {
  Model model = Model::cube();
  model.faces.insert(model.faces.begin() + 5, {0, 1});
  model.faces.push_back({});
  model.faces.push_back({3});
  std::vector<Written> files = in_indexed_formats(model);
  files.push_back({SurfaceFormat::kStl, to_text_stl(model)});
  for (const auto& [format, bytes] : files) {
    EXPECT_THAT(expect_cube(bytes, format).remarks, Contains("3 faces of fewer than three corners left out."));
  }
}

TEST(SurfaceKinds, VerticesOfNoFaceCountForNothing) {
  Model model = Model::cube();
  model.vertices.insert(model.vertices.begin(), {5000, 0, 0});
  model.vertices.push_back({std::nan(""), INFINITY, 0});
  for (Face& face : model.faces) {
    for (int& corner : face) ++corner;
  }
  for (const auto& [format, bytes] : in_indexed_formats(model)) {
    const ScannedSurface mesh = expect_cube(bytes, format);
    EXPECT_THAT(mesh.remarks, Contains("2 vertices of no face left out."));
    EXPECT_DOUBLE_EQ(mesh.points(0, 0), -0.05) << "the others keep their order";
  }
  model.faces.push_back({1, 2, 9});
  for (const auto& [format, bytes] : in_indexed_formats(model)) {
    const auto mesh = read_surface(bytes, format, 1e-3);
    EXPECT_THAT(std::string(mesh.status().message()), HasSubstr("a face has a corner at this vertex"));
  }
}

TEST(SurfaceKinds, NotANumberInEverySpelling) {
  for (const char* word : {"nan", "NaN", "-nan", "nan(ind)", "inf", "-Infinity", "1.#QNAN", "-1.#IND", "1e999"}) {
    const std::string obj = absl::StrCat(to_obj(Model::cube()), "v 0 ", word, " 0\n");
    EXPECT_THAT(expect_cube(obj, SurfaceFormat::kObj).remarks, Contains("1 vertex of no face left out.")) << word;
    std::string ply = to_text_ply(Model::cube());
    ply = absl::StrReplaceAll(ply, {{"element face", "property float quality\nelement face"}});
    for (const auto& v : kCube) {
      const std::string line = absl::StrCat("\n", absl::StrJoin(v, " "), "\n");
      ply = absl::StrReplaceAll(ply, {{line, absl::StrCat("\n", absl::StrJoin(v, " "), " ", word, "\n")}});
    }
    EXPECT_THAT(expect_cube(ply, SurfaceFormat::kPly).remarks, IsEmpty()) << word;
  }
}

TEST(SurfaceKinds, IndicesOfEveryWidth) {
  const Model model = Model::cube();
  for (const bool big : {false, true}) {
    expect_cube(to_binary_ply<int8_t>(model, "char", big), SurfaceFormat::kPly);
    expect_cube(to_binary_ply<uint16_t>(model, "uint16", big), SurfaceFormat::kPly);
    expect_cube(to_binary_ply<int64_t>(model, "int64", big), SurfaceFormat::kPly);
    expect_cube(to_binary_ply<uint64_t>(model, "uint64", big), SurfaceFormat::kPly);
  }
}

TEST(SurfaceKinds, StripsOfTriangles) {
  const std::string head =
      absl::StrCat("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n");
  std::string vertices;
  for (const auto& v : kCube) absl::StrAppend(&vertices, absl::StrJoin(v, " "), "\n");
  const std::string one = "29 0 3 1 2 -1 4 5 7 6 -1 0 1 4 5 -1 1 2 5 6 -1 2 3 6 7 -1 3 0 7 4\n";
  expect_cube(head + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + vertices + one,
              SurfaceFormat::kPly);
  // One record a side; then strips joined by triangles of no area, and strips before the vertices.
  const std::string six = "4 0 3 1 2\n4 4 5 7 6\n4 0 1 4 5\n4 1 2 5 6\n4 2 3 6 7\n4 3 0 7 4\n";
  expect_cube(head + "element tristrips 6\nproperty list int uint vertex_index\nend_header\n" + vertices + six,
              SurfaceFormat::kPly);
  const std::string joined = "34 0 3 1 2 2 4 4 5 7 6 6 0 0 1 4 5 5 1 1 2 5 6 6 2 2 3 6 7 7 3 3 0 7 4\n";
  expect_cube(head + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + vertices + joined,
              SurfaceFormat::kPly);
}

TEST(SurfaceKinds, ContinuationLines) {
  const std::string obj =
      absl::StrReplaceAll(to_obj(Model::cube()), {{"f 1 ", "f 1 \\\n  "}, {"v -50 ", "v\\\n-50 \\ \n"}});
  expect_cube(obj, SurfaceFormat::kObj);
  expect_cube(absl::StrReplaceAll(obj, {{"\n", "\r\n"}}), SurfaceFormat::kObj);
  // A backslash is part of a path, and of a comment.
  expect_cube(
      absl::StrReplaceAll(to_obj(Model::cube()), {{"mtllib a.mtl\n", "mtllib C:\\faces\\\n# C:\\faces\\\ng a\\\n"}}),
      SurfaceFormat::kObj);
}

TEST(SurfaceKinds, UnknownStatementsArePassedOverWithARemark) {
  const std::string obj = to_obj(Model::cube()) + "cstype bspline\ncurv 0 1 1 2\nend\n";
  EXPECT_THAT(expect_cube(obj, SurfaceFormat::kObj).remarks,
              Contains("3 statements that shape no polygon passed over: 'cstype', 'curv', 'end'."));
  const std::string ply =
      absl::StrReplaceAll(to_text_ply(Model::cube()),
                          {{"element face", "texture a.png\nelement edge 0\nproperty int vertex1\nelement face"}});
  EXPECT_THAT(expect_cube(ply, SurfaceFormat::kPly).remarks, Contains(HasSubstr("1 line of the PLY header")));
  const std::string stl = "solid\nendsolid\nmade by hand\n" + to_text_stl(Model::cube());
  EXPECT_THAT(expect_cube(stl, SurfaceFormat::kStl).remarks, Contains("1 line outside the solids passed over."));
}

TEST(SurfaceKinds, ElementsThatShapeNoSurface) {
  std::string ply = absl::StrReplaceAll(to_text_ply(Model::cube()),
                                        {{"end_header", "element edge 2\nproperty int a\nproperty int b\nend_header"}});
  EXPECT_THAT(expect_cube(ply + "0 1\n1 2\nmore", SurfaceFormat::kPly).remarks,
              ::testing::ElementsAre("2 of element 'edge' passed over: they shape no surface.",
                                     "5 bytes behind the last element passed over."));
}

TEST(SurfaceKinds, EverySolidInEverySpelling) {
  const Model cube = Model::cube();
  Model left = cube;
  Model right = cube;
  left.faces.resize(6);
  right.faces.erase(right.faces.begin(), right.faces.begin() + 6);
  const std::string both = to_text_stl(left) + to_text_stl(right);
  EXPECT_THAT(expect_cube(both, SurfaceFormat::kStl).remarks, Contains(HasSubstr("2 solids")));
  std::string upper = both;
  absl::AsciiStrToUpper(&upper);
  expect_cube(upper, SurfaceFormat::kStl);
  expect_cube(absl::StrReplaceAll(both, {{"solid", "Solid"}, {"facet", "FACET"}}), SurfaceFormat::kStl);
  expect_cube(absl::StrCat(" \n\t", both), SurfaceFormat::kStl);
  expect_cube(absl::StrReplaceAll(both, {{"1\n  outer loop\n", "1 outer loop "}}), SurfaceFormat::kStl);
  expect_cube(absl::StrReplaceAll(both, {{" cube", ""}}), SurfaceFormat::kStl);
}

TEST(SurfaceKinds, SpareBytesBehindBinaryStl) {
  for (const char* header : {"made for a test", "solid cube", " SOLID cube"}) {
    const std::string bytes = to_binary_stl(Model::cube(), header);
    EXPECT_THAT(expect_cube(bytes, SurfaceFormat::kStl).remarks, IsEmpty());
    EXPECT_THAT(expect_cube(bytes + "\n", SurfaceFormat::kStl).remarks, Contains(HasSubstr("1 byte behind")));
    EXPECT_THAT(expect_cube(bytes + std::string(100, ' '), SurfaceFormat::kStl).remarks, SizeIs(1));
    std::string unknown = bytes;
    unknown.replace(80, 4, 4, '\0');
    EXPECT_THAT(expect_cube(unknown, SurfaceFormat::kStl).remarks, Contains(HasSubstr("promises no triangle")));
    EXPECT_FALSE(read_surface(bytes.substr(0, bytes.size() - 1), SurfaceFormat::kStl, 1e-3).ok());
  }
}

/// A file of ../shared/data/reader_cases, and what of its remarks is expected.
struct SharedCase {
  const char* file;
  const char* remark = nullptr;
};

void PrintTo(const SharedCase& shared, std::ostream* out) {
  *out << shared.file;
}

class SharedCases : public ::testing::TestWithParam<SharedCase> {};

TEST_P(SharedCases, IsTheCube) {
  const std::filesystem::path path = std::filesystem::path(LIPOFILL_SHARED_DATA) / "reader_cases" / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
  std::ifstream in(path, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  const std::string ending = path.extension();
  const SurfaceFormat format = ending == ".obj"   ? SurfaceFormat::kObj
                               : ending == ".ply" ? SurfaceFormat::kPly
                                                  : SurfaceFormat::kStl;
  const ScannedSurface mesh = expect_cube(bytes.str(), format);
  if (GetParam().remark != nullptr) {
    EXPECT_THAT(mesh.remarks, Contains(HasSubstr(GetParam().remark)));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, SharedCases,
                         ::testing::Values(SharedCase{"obj_backslash.obj"}, SharedCase{"obj_bom.obj"},
                                           SharedCase{"obj_cr_only.obj"},
                                           SharedCase{"obj_short_face.obj", "1 face of fewer than three corners"},
                                           SharedCase{"obj_stray_vertex.obj", "2 vertices of no face"},
                                           SharedCase{"obj_unknown_statement.obj", "13 statements"},
                                           SharedCase{"ply_ascii_nan_attribute.ply"}, SharedCase{"ply_int64_index.ply"},
                                           SharedCase{"ply_tristrips.ply"},
                                           SharedCase{"stl_two_solids.stl", "2 solids"},
                                           SharedCase{"stl_uppercase.stl"}, SharedCase{"stl_leading_blank.stl"},
                                           SharedCase{"stl_binary_trailing_byte.stl", "behind the last triangle"},
                                           SharedCase{"stl_binary_solid_header_trailing_bytes.stl", "behind"}),
                         [](const auto& test) {
                           std::string name = test.param.file;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

}  // namespace
}  // namespace lipofill::geometry
