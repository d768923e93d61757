// lipofill report: every figure of the page is traced to the field that it comes from, and that to
// what the daemon answers; equal inputs give equal bytes; what was not asked for is said.

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <sstream>
#include <vector>

#include "tests/integration/cli/cli_fixture.h"
#include "tests/integration/service/daemon_process.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A figure on the page.
struct Shown {
  std::string value;
  std::string field;
  std::string unit;
  std::string text;
};

std::vector<Shown> figures_of(const std::string& html) {
  static const std::regex data(
      "<data value=\"([^\"]*)\" data-field=\"([^\"]*)\"(?: data-unit=\"([^\"]*)\")?>([^<]*)</data>");
  std::vector<Shown> figures;
  for (auto it = std::sregex_iterator(html.begin(), html.end(), data); it != std::sregex_iterator(); ++it) {
    figures.push_back({(*it)[1], (*it)[2], (*it)[3], (*it)[4]});
  }
  return figures;
}

/// From a field of the record to what is shown of it, by the unit in the field's own name.
double scale_of(const Shown& figure) {
  if (figure.unit == "mmHg") return 1.0 / 133.322;
  if (figure.unit == "kPa" && figure.field.ends_with("_pa")) return 1e-3;
  return figure.unit == "%" ? 100.0 : 1.0;
}

/// What the words on the page say, as a number; its decimals bound how far it is rounded.
double read_number(std::string text, double& half_a_digit) {
  text = std::regex_replace(text, std::regex("\u2212"), "-");
  const size_t unit = text.find("\u00a0");
  if (unit != std::string::npos) text.resize(unit);
  std::replace(text.begin(), text.end(), ',', '.');
  const size_t point = text.find('.');
  const double decimals = point == std::string::npos ? 0.0 : static_cast<double>(text.size() - point - 1);
  half_a_digit = 0.5000001 * std::pow(10.0, -decimals);
  return std::stod(text);
}

/// Every figure of the page is the field of the record that it names, rounded.
void expect_traced(const std::string& html, const json& record, size_t least) {
  const std::vector<Shown> figures = figures_of(html);
  EXPECT_GE(figures.size(), least);
  for (const Shown& figure : figures) {
    const json::json_pointer field(figure.field);
    ASSERT_TRUE(record.contains(field)) << figure.field;
    const double value = record.at(field).get<double>();
    EXPECT_EQ(std::stod(figure.value), value) << figure.field;
    double half_a_digit = 0.0;
    const double shown = read_number(figure.text, half_a_digit);
    EXPECT_NEAR(shown, value * scale_of(figure), half_a_digit) << figure.field;
  }
}

size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class ReportCliTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write_plan("plan.json", "/name", "plate");
  }

  static constexpr char kSmall[] = " --members 50 --month 3 --month 12 --date 2026-11-30 ";
};

TEST_F(ReportCliTest, SaysTheSameInEveryForm) {
  const json record = answer_of(std::string("lipofill report plan.json --out r --spawn --no-pdf") + kSmall);
  EXPECT_EQ(read_json("r/report.json"), record);
  EXPECT_FALSE(exists("r/.lipofilld"));
  EXPECT_FALSE(exists("r/report.pdf"));
  const std::string html = read("r/report.html");
  expect_traced(html, record, 100);
  const std::string csv = read("r/report.csv");
  const std::vector<Shown> figures = figures_of(html);
  EXPECT_EQ(count_of(csv, "\n"), figures.size() + 1) << "the CSV has the figures of the page";
  for (const Shown& figure : figures) EXPECT_THAT(csv, HasSubstr("," + figure.field + "\n"));
  EXPECT_THAT(
      html,
      HasSubstr("lipofill report plan.json --no-pdf --members 50 --month 3 --month 12 --date 2026-11-30 --out report "
                "--spawn"));
  EXPECT_THAT(html, HasSubstr(record.at("model").at("report").at("content_hash").get<std::string>()));
  EXPECT_THAT(html, HasSubstr("No target was asked for"));
  EXPECT_THAT(html, HasSubstr("Research and planning aid, not a medical device"));
  EXPECT_EQ(count_of(html, "<img "), 17u) << "three shapes from five sides, and two maps";
}

TEST_F(ReportCliTest, EqualInputsHaveEqualBytes) {
  const auto make = [&](const std::string& folder) {
    const CommandResult made =
        run("lipofill report plan.json --out " + folder + " --spawn --quiet --no-pdf --no-forecast --date 2026-11-30");
    EXPECT_EQ(made.exit_code, 0) << made.errors;
  };
  make("first");
  make("second");
  for (const char* file : {"/report.html", "/report.json", "/report.csv"}) {
    EXPECT_EQ(read(std::string("first") + file), read(std::string("second") + file)) << file;
  }
}

TEST_F(ReportCliTest, FiguresAreThoseThatTheDaemonAnswers) {
  const DaemonProcess daemon((folder_ / "data").string());
  const std::string lipofill = "env LIPOFILL_SERVER=" + daemon.address() + " lipofill ";
  const json record = answer_of(lipofill + "report plan.json --out r --keep --no-pdf" + kSmall);
  expect_traced(read("r/report.html"), record, 100);

  const json listed = answer_of(lipofill + "simulation list").at("simulations");
  ASSERT_EQ(listed.size(), 2u);
  for (const char* shape : {"planned", "remaining"}) {
    const json& summary = record.at(shape).at("summary");
    const auto kept = std::find_if(listed.begin(), listed.end(), [&](const json& simulation) {
      return simulation.at("summary").at("state_hash") == summary.at("state_hash");
    });
    ASSERT_NE(kept, listed.end()) << shape;
    for (const char* figure : {"injected_ml", "skin_max_displacement_mm", "skin_volume_change_ml", "max_pressure_pa"}) {
      EXPECT_EQ(kept->at("summary").at(figure), summary.at(figure)) << figure;
    }
    EXPECT_EQ(kept->at("summary").at("zones").at(0).at("mean_pressure_pa"),
              summary.at("zones").at(0).at("mean_pressure_pa"));
  }

  const json forecast =
      answer_of(lipofill + "forecast plan.json --out f --members 50 --month 3 --month 12 --figures-only");
  EXPECT_EQ(record.at("forecast").at("times").at(0).at("bands"), forecast.at("times").at(0).at("bands"));
  EXPECT_EQ(record.at("forecast").at("zones").at(0).at("inject_ml"), forecast.at("zones").at(0).at("inject_ml"));
  const json& zone = record.at("volumes").at("zones").at(0);
  EXPECT_EQ(zone.at("remaining_ml"), forecast.at("zones").at(0).at("remaining_ml"));
  EXPECT_EQ(zone.at("inject_ml"), forecast.at("zones").at(0).at("planned_ml"));
  EXPECT_DOUBLE_EQ(zone.at("prepare_ml").get<double>(), 1.1 * zone.at("inject_ml").get<double>());
  EXPECT_EQ(record.at("volumes").at("sessions").at(0).at("zones").at(0).at("inject_ml"),
            forecast.at("sessions").at(0).at("inject_ml").at(0));

  const json retention = answer_of(lipofill + "retention --month 3 --month 12");
  EXPECT_EQ(record.at("remaining").at("share"), retention.at("months").at(1).at("p50"));
  EXPECT_NEAR(record.at("remaining").at("summary").at("injected_ml").get<double>(),
              0.3 * retention.at("months").at(1).at("p50").get<double>(), 1e-9);
  const json delivery = answer_of(lipofill + "deliver plan.json --out d");
  EXPECT_EQ(record.at("delivery").at("passes").size(), delivery.at("passes").size());
  EXPECT_EQ(record.at("delivery").at("entries").at(0).at("volume_ml"), delivery.at("entries").at(0).at("volume_ml"));
}

TEST_F(ReportCliTest, SpeaksGermanAndSaysWhatWasNotAskedFor) {
  const CommandResult made =
      run("lipofill report plan.json --out r --spawn --quiet --no-pdf --no-forecast --language de --paper letter "
          "--pseudonym "
          "fall-7 --date 2026-11-30");
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  const std::string html = read("r/report.html");
  expect_traced(html, read_json("r/report.json"), 30);
  EXPECT_THAT(html, HasSubstr("<html lang=\"de\">"));
  EXPECT_THAT(html, HasSubstr("size: letter"));
  EXPECT_THAT(html, HasSubstr("fall-7"));
  EXPECT_THAT(html, HasSubstr("kein Medizinprodukt"));
  EXPECT_THAT(html, HasSubstr("Es wurde kein Ziel verlangt"));
  EXPECT_THAT(html, HasSubstr("Es wurde keine Vorhersage verlangt"));
  EXPECT_THAT(html, HasSubstr("0,30")) << "a decimal comma";
  EXPECT_THAT(html, HasSubstr("<td lang=\"en\">")) << "sources are in English, and said to be";
  EXPECT_EQ(count_of(html, "<img "), count_of(html, "<img alt=\""));
  EXPECT_THAT(html, Not(HasSubstr("<img alt=\"\"")));
  EXPECT_EQ(count_of(html, "<table"), count_of(html, "<caption>"));
  EXPECT_EQ(count_of(html, "<th scope=\""), count_of(html, "<th ") + count_of(html, "<th>"));
}

TEST_F(ReportCliTest, IsPrintedWithItsTags) {
  if (run("which chromium").exit_code != 0) GTEST_SKIP() << "chromium is not installed";
  const CommandResult made = run("lipofill report plan.json --out r --spawn --no-forecast --date 2026-11-30");
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  EXPECT_THAT(made.output, HasSubstr("report.pdf"));
  const std::string pdf = read("r/report.pdf");
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_THAT(pdf, HasSubstr("/StructTreeRoot"));
  EXPECT_THAT(pdf, HasSubstr("/Lang (en)"));
}

TEST_F(ReportCliTest, GoesOnWithoutWhatItPrintsAndDrawsWith) {
  const CommandResult made = run(
      "env PATH=/nowhere \"$(command -v lipofill)\" report plan.json --out r --spawn --no-forecast --date 2026-11-30");
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  EXPECT_THAT(made.output, HasSubstr("no report.pdf: printing needs Chromium: 'apt-get install chromium'"));
  EXPECT_THAT(made.output, HasSubstr("no pictures: drawing needs an X server"));
  const std::string html = read("r/report.html");
  EXPECT_THAT(html, HasSubstr("The pictures could not be drawn: drawing needs an X server"));
  EXPECT_THAT(html, Not(HasSubstr("<img ")));
  expect_traced(html, read_json("r/report.json"), 30);
}

TEST_F(ReportCliTest, RefusesWithTheOption) {
  const auto refusal_of = [&](const std::string& options) {
    const CommandResult result = run("lipofill report plan.json --out r --spawn --quiet " + options);
    EXPECT_EQ(result.exit_code, 2) << options;
    return result.errors;
  };
  EXPECT_THAT(refusal_of("--date 2026-02-30"), HasSubstr("--date: is '2026-02-30', must be a day as YYYY-MM-DD"));
  EXPECT_THAT(refusal_of("--pseudonym 'Jane Doe'"), HasSubstr("--pseudonym: is 'Jane Doe'"));
  EXPECT_THAT(refusal_of("--target a.obj --healthy left"), HasSubstr("--healthy: is given beside --target"));
  EXPECT_THAT(refusal_of("--reserve-percent 200"), HasSubstr("--reserve-percent: is 200, must be in [0, 100]"));
  EXPECT_THAT(refusal_of("--members 20000"), HasSubstr("--members: is 20000, must be in [50, 10000]"));
  EXPECT_THAT(refusal_of("--language fr"), HasSubstr("fr"));
}

/// A head whose left cheek has sunk in by 5 mm.
class ReportOnAFaceTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::vector<planning::Bump> bumps = planning::symmetric_bumps();
    const geometry::SurfaceMesh healthy = planning::make_head(bumps);
    bumps.push_back({{0.75, -0.35, 0.4}, 0.25, -0.005});
    write_surface("face.obj", planning::make_head(bumps));
    json landmarks;
    for (const auto& [name, p] : planning::make_landmarks(healthy)) {
      landmarks["landmarks"][name] = {1e3 * p[0], 1e3 * p[1], 1e3 * p[2]};
    }
    write("face.json", landmarks.dump());
    write("plan.json", R"({"name": "cheek", "scan": {"file": "face.obj", "landmarks_file": "face.json"},
      "model": {"scan_region": {}, "n_xi": 20, "n_eta": 20, "tissue_preset": "PAPER",
                "layers": [{"name": "skin"}, {"name": "muscle"}]},
      "simulation": {"films": [{"name": "deep", "below_layer": "skin", "zones": [{"name": "cheek", "region": "masseter_left"}]}],
                     "injections": [{"zone": "cheek", "volume_ml": 2, "rate_ml_per_s": 1}]}})");
  }

  void write_surface(const std::string& name, const geometry::SurfaceMesh& mesh) const {
    std::ostringstream text;
    text.precision(10);
    for (int v = 0; v < mesh.n_vertices(); ++v) text << "v " << 1e3 * mesh.points.col(v).transpose() << "\n";
    for (const auto& t : mesh.triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    write(name, text.str());
  }
};

TEST_F(ReportOnAFaceTest, TellsWhatIsMissingBeforeAndAfter) {
  const json record = answer_of(
      "lipofill report plan.json --out r --spawn --healthy right --no-forecast --no-pdf --pseudonym case-7 --date "
      "2026-11-30");
  const std::string html = read("r/report.html");
  expect_traced(html, record, 80);
  EXPECT_EQ(count_of(html, "<img "), 25u) << "four shapes from five sides, and five maps";
  EXPECT_THAT(html, HasSubstr("alt=\"The skin before, view: left oblique\""));
  EXPECT_THAT(html, HasSubstr("mirrored from: right"));
  const json alone = answer_of("lipofill target face.obj --landmarks face.json --healthy right");
  EXPECT_EQ(record.at("deficit").at("all").at("volume"), alone.at("deficit").at("all").at("volume"));
  const json& planned = record.at("planned").at("evaluation");
  EXPECT_LT(planned.at("without_rim").at("volume").at("deficit_ml"),
            planned.at("without_rim_before").at("volume").at("deficit_ml"));
  EXPECT_GT(record.at("remaining").at("evaluation").at("without_rim").at("volume").at("deficit_ml"),
            planned.at("without_rim").at("volume").at("deficit_ml"));
}

}  // namespace
}  // namespace lipofill::testing
