#include "client/cpp/landmark_formats.h"

#include <gmock/gmock.h>

#include "client/cpp/landmark_names.h"
#include "client/cpp/landmarks_file.h"
#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(LandmarkNames, AreUnderstoodInCommonSchemes) {
  for (const char* name : {"gonion_left", "Gonion Left", "left gonion", "go_l", "GoL", "goL", "L-go", "go.l", "go (L)",
                           "gonionLeft", "LGo", "gol", "soft tissue gonion, left", "GO_LT"}) {
    EXPECT_EQ(understand_landmark_name(name), "gonion_left") << name;
  }
  for (const auto& [name, expected] : {std::pair("zy_r", "zygion_right"),
                                       {"chR", "cheilion_right"},
                                       {"tr_r", "tragion_right"},
                                       {"t-l", "tragion_left"},
                                       {"tR", "tragion_right"},
                                       {"ex_right", "exocanthion_right"},
                                       {"exR", "exocanthion_right"},
                                       {"al_l", "alare_left"},
                                       {"me", "menton"},
                                       {"Pg", "pogonion"},
                                       {"pog'", "pogonion"},
                                       {"Sn", "subnasale"},
                                       {"prn", "pronasale"},
                                       {"n", "nasion"},
                                       {"N'", "nasion"},
                                       {"nose tip", "pronasale"}}) {
    EXPECT_EQ(understand_landmark_name(name), expected) << name;
  }
  for (const char* name : {"", "F-1", "tr", "go", "left", "n_left", "sto", "gnathion", "left right go", "l"}) {
    EXPECT_EQ(understand_landmark_name(name), std::nullopt) << name;
  }
}

TEST(LandmarkTable, IsReadHoweverItIsWritten) {
  const auto expected = ElementsAre(std::pair("n", Point{0, 85.5, -1}), std::pair("go l", Point{62, 9, 3e1}));
  for (const char* text :
       {"n,0,85.5,-1\ngo l,62,9,3e1\n", "name,x,y,z\r\nn,0,85.5,-1\r\n\"go l\",62,9,30",
        "\xEF\xBB\xBFlabel;x_mm;y_mm;z_mm\nn;0;85,5;-1\ngo l;62;9;30\n",
        "x (mm)\ty (mm)\tz (mm)\tLandmark\n0\t85.5\t-1\tn\n62\t9\t30\tgo l\n",
        "# made by hand\r0,85.5,-1,n\r\r62,9,30,go l\r", "1,n,0,85.5,-1\n2,go l,62,9,30",
        "1,0,85.5,-1,n\n2,62,9,30,go l", "label,l,p,s,defined\nn,0,85.5,-1,1\ngo l,62,9,30,1\nme,,,,0\n",
        "label,r,a,s\nn,-0,-85.5,-1\ngo l,-62,-9,30\n"}) {
    const auto list = parse_landmark_table(text);
    ASSERT_TRUE(list.ok()) << text << list.status();
    EXPECT_THAT(list->points, expected) << text;
  }
  EXPECT_DOUBLE_EQ(*parse_landmark_table("name,x_m,y_m,z_m\n")->mm_per_unit, 1000.0);
  EXPECT_EQ(parse_landmark_table("name,x,y,z\n")->mm_per_unit, std::nullopt);
  for (const auto& [text, complaint] : {std::pair("n,0,1\n", "line 1: 3 columns"),
                                        {"n,0,1,abc\n", "coordinate 3 of 'n' is 'abc'"},
                                        {"name,x,y,z\nn,0,nan,1\n", "line 2: coordinate 2"},
                                        {"x,y,z\n1,2,3\n", "no column has the names"}}) {
    EXPECT_THAT(std::string(parse_landmark_table(text).status().message()), HasSubstr(complaint)) << text;
  }
}

TEST(Fcsv, HonoursItsCoordinateSystem) {
  const std::string row = "vtkMRMLMarkupsFiducialNode_1,1,2,3,0,0,0,1,1,1,0,nasion,,\n";
  const auto point = [&row](const std::string& head) {
    const auto list = parse_fcsv(head + row);
    EXPECT_TRUE(list.ok()) << list.status();
    return list.ok() ? list->points.at(0).second : Point{};
  };
  EXPECT_EQ(point("# CoordinateSystem = LPS\n"), (Point{1, 2, 3}));
  EXPECT_EQ(point("# CoordinateSystem = 1\r\n"), (Point{1, 2, 3}));
  EXPECT_EQ(point("# CoordinateSystem = RAS\n"), (Point{-1, -2, 3}));
  EXPECT_EQ(point("# CoordinateSystem = 0\n"), (Point{-1, -2, 3}));
  EXPECT_EQ(point(""), (Point{-1, -2, 3}));
  EXPECT_THAT(std::string(parse_fcsv("# CoordinateSystem = IJK\n").status().message()), HasSubstr("'IJK'"));
  EXPECT_THAT(parse_fcsv("# columns = label,x,y,z,sel,vis\nnasion,-1,-2,3,1,1\n")->points,
              ElementsAre(std::pair("nasion", Point{1, 2, 3})));
}

TEST(SlicerMarkups, HonourFrameUnitAndWhatIsPlaced) {
  const auto parse = [](const std::string& markup) {
    return parse_slicer_markups(nlohmann::json::parse(R"({"markups": [{)" + markup + "}]}"));
  };
  const std::string points = R"("controlPoints": [{"label": "n", "position": [1, 2, 3], "positionStatus": "defined"},
      {"label": "me", "position": [0, 0, 0], "positionStatus": "undefined"}])";
  EXPECT_THAT(parse(points)->points, ElementsAre(std::pair("n", Point{1, 2, 3})));
  EXPECT_EQ(parse(points)->passed_over, 1u);
  const auto ras = parse(R"("coordinateSystem": "RAS", "coordinateUnits": ["m", "UCUM", "metre"],)" + points);
  EXPECT_THAT(ras->points, ElementsAre(std::pair("n", Point{-1, -2, 3})));
  EXPECT_TRUE(ras->was_ras);
  EXPECT_EQ(ras->mm_per_unit, 1000.0);
  for (const auto& [markup, complaint] :
       {std::pair(R"("coordinateSystem": "IJK", "controlPoints": [])", "'IJK'"),
        {R"("coordinateUnits": "inch", "controlPoints": [])", "inch"},
        {R"("controlPoints": [{"label": "n", "position": [1, 2]}])", "controlPoints[0] has no position"},
        {R"("controlPoints": [{"label": "n", "position": [1, 2, null]}])", "position[2] is not a number"}}) {
    EXPECT_THAT(std::string(parse(markup).status().message()), HasSubstr(complaint));
  }
  EXPECT_FALSE(parse_slicer_markups(nlohmann::json::parse("[]")).ok());
}

TEST(PickedPoints, AreThoseThatAreActive) {
  const auto list = parse_picked_points(
      "<!DOCTYPE PickedPoints><PickedPoints><DocumentData><point x='9'/></DocumentData>"
      "<point z='3' y=\"2\" x='1' name='go &lt;l&gt;' active='1'/><point active='0' x='0' y='0' z='0' name='me'/>"
      "</PickedPoints>");
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_THAT(list->points, ElementsAre(std::pair("go <l>", Point{1, 2, 3})));
  EXPECT_EQ(list->passed_over, 1u);
  EXPECT_THAT(std::string(parse_picked_points("<PickedPoints><point").status().message()), HasSubstr("is not XML"));
  const char* laughs = "<!DOCTYPE a [<!ENTITY b \"xx\"><!ENTITY c \"&b;&b;\">]><PickedPoints/>";
  EXPECT_THAT(std::string(parse_picked_points(laughs).status().message()), HasSubstr("declares entities"));
  EXPECT_THAT(std::string(parse_picked_points("<a/>").status().message()), HasSubstr("no element PickedPoints"));
  EXPECT_THAT(
      std::string(
          parse_picked_points("<PickedPoints>\n<point name='n' x='1' y='b' z='1'/></PickedPoints>").status().message()),
      HasSubstr("line 2: point 'n' has y=\"b\""));
}

using LandmarkFiles = TemporaryFolderTest;

TEST_F(LandmarkFiles, GoOutAndComeBackInEveryFormat) {
  Landmarks landmarks;
  landmarks.points_mm = {
      {"nasion", {0, 85.414, 111.055}}, {"gonion_left", {62.268, 8.97, -32.901}}, {"a, \"b\"", {1, 2, 3}}};
  for (const char* name : {"a.json", "a.mrk.json", "a.fcsv", "a.pp", "a.csv"}) {
    ASSERT_TRUE(save_landmarks(landmarks, folder_ / name).ok()) << name;
    const auto back = load_landmarks((folder_ / name).string(), v1::MILLIMETRE);
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(back->points_mm, landmarks.points_mm) << name;
  }
}

TEST_F(LandmarkFiles, TakeTheDaemonsNamesAndSayWhatWasMade) {
  const auto landmarks = load_landmarks(
      write("a.fcsv", "1,1,2,3,0,0,0,1,1,1,0,go_l,,\n2,0,0,0,0,0,0,1,1,1,0,F-2,,\n").string(), v1::METRE);
  ASSERT_TRUE(landmarks.ok()) << landmarks.status();
  EXPECT_EQ(landmarks->points_mm.at("gonion_left"), (Point{-1000, -2000, 3000}));
  EXPECT_TRUE(landmarks->points_mm.contains("F-2"));
  EXPECT_THAT(landmarks->remarks, Contains(HasSubstr("turned to LPS")));
  EXPECT_THAT(landmarks->remarks, Contains(HasSubstr("1 of the names")));
  const auto twice = load_landmarks(write("b.csv", "n,0,0,0\nnasion,0,0,1\n").string(), v1::MILLIMETRE);
  EXPECT_THAT(std::string(twice.status().message()), HasSubstr("is there twice, as 'n' and 'nasion'"));
  EXPECT_THAT(std::string(load_landmarks(write("c.csv", "").string(), v1::MILLIMETRE).status().message()),
              HasSubstr("has no landmark"));
  // In the project's own JSON a plan may name them as the file does.
  const auto own = load_landmarks(write("d.json", R"({"landmarks": {"go_l": [1, 2, 3]}})").string(), v1::MILLIMETRE);
  EXPECT_EQ(own->points_mm.at("gonion_left"), own->points_mm.at("go_l"));
}

TEST_F(LandmarkFiles, AHashMayBePartOfAName) {
  std::filesystem::create_directory(folder_ / "case #3");
  const std::string text = R"({"landmarks": {"nasion": [1, 2, 3]}, "before": {"menton": [4, 5, 6]}})";
  const std::string file = write("case #3/a#1.json", text).string();
  EXPECT_TRUE(load_landmarks(file, v1::MILLIMETRE)->points_mm.contains("nasion"));
  EXPECT_TRUE(load_landmarks(file + "#before", v1::MILLIMETRE)->points_mm.contains("menton"));
  EXPECT_THAT(std::string(load_landmarks((folder_ / "case #3/none.json").string(), v1::MILLIMETRE).status().message()),
              HasSubstr("case #3/none.json does not exist"));
}

TEST_F(LandmarkFiles, OfOtherProgramsAreThoseOfTheSampleFace) {
  const std::filesystem::path cases = std::filesystem::path(LIPOFILL_SHARED_DATA) / "reader_cases";
  if (!std::filesystem::exists(cases)) GTEST_SKIP() << "no files in " << cases;
  const auto expected = load_landmarks((cases / "case #3/faces/half_face.landmarks.json").string(), v1::MILLIMETRE);
  ASSERT_TRUE(expected.ok()) << expected.status();
  for (const char* name : {"landmarks.mrk.json", "landmarks.fcsv", "landmarks.pp", "landmarks_in_metres.json"}) {
    const auto read = load_landmarks((cases / name).string(), v1::MILLIMETRE);
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_THAT(read->remarks, IsEmpty());
    ASSERT_EQ(read->points_mm.size(), expected->points_mm.size());
    for (const auto& [landmark, point] : expected->points_mm) {
      for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(read->points_mm.at(landmark)[c], point[c], 1e-9) << name << landmark;
    }
  }
}

}  // namespace
}  // namespace lipofill::client
