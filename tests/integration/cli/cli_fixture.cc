#include "tests/integration/cli/cli_fixture.h"

#include <stdlib.h>

#include <fstream>
#include <sstream>

namespace lipofill::testing {

void CliTest::SetUp() {
  std::string name = (std::filesystem::temp_directory_path() / "lipofill-cli-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  folder_ = name;
  std::filesystem::copy_file(LIPOFILL_SMALL_PLAN, folder_ / "plan.json");
}

nlohmann::json CliTest::answer_of(const std::string& line) const {
  const CommandResult result = run(line + " --json");
  EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.errors;
  const auto answer = nlohmann::json::parse(result.output, nullptr, false);
  EXPECT_FALSE(answer.is_discarded()) << line << "\n" << result.output;
  return answer;
}

void CliTest::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
}

std::string CliTest::read(const std::string& name) const {
  std::ifstream stream(folder_ / name, std::ios::binary);
  EXPECT_TRUE(stream) << name;
  return {std::istreambuf_iterator<char>(stream), {}};
}

void CliTest::write_plan(const std::string& name, const std::string& pointer, const nlohmann::json& value) const {
  nlohmann::json plan = read_json("plan.json");
  plan[nlohmann::json::json_pointer(pointer)] = value;
  write(name, plan.dump(2));
}

void CliTest::write_plane(const std::string& name, double height_mm) const {
  constexpr int kPoints = 9;
  constexpr double kLength = 40.0;
  std::ostringstream obj;
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      obj << "v " << kLength * i / (kPoints - 1) << " " << kLength * j / (kPoints - 1) << " " << height_mm << "\n";
    }
  }
  for (int j = 0; j + 1 < kPoints; ++j) {
    for (int i = 0; i + 1 < kPoints; ++i) {
      const int a = j * kPoints + i + 1;
      obj << "f " << a << " " << a + 1 << " " << a + kPoints + 1 << " " << a + kPoints << "\n";
    }
  }
  write(name, obj.str());
}

}  // namespace lipofill::testing
