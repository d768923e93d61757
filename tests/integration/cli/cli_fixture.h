#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/integration/cli/shell.h"

namespace lipofill::testing {

/// A folder for the test with the small square plan in it, in which all commands run.
class CliTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override { std::filesystem::remove_all(folder_); }

  CommandResult run(const std::string& line) const { return run_shell(in_folder(line)); }
  /// The JSON a command answers with; a failure when it does not succeed.
  nlohmann::json answer_of(const std::string& line) const;
  std::string in_folder(const std::string& line) const { return "cd '" + folder_.string() + "' && exec " + line; }

  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  nlohmann::json read_json(const std::string& name) const { return nlohmann::json::parse(read(name)); }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  /// A copy of the small plan with one value changed, by its JSON pointer.
  void write_plan(const std::string& name, const std::string& pointer, const nlohmann::json& value) const;
  /// A flat surface over the plan's square at a height, as an OBJ.
  void write_plane(const std::string& name, double height_mm) const;

  std::filesystem::path folder_;
};

}  // namespace lipofill::testing
