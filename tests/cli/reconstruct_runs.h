// Runs of soapfilm reconstruct whose report shows the effect of an option.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"

namespace soapfilm::test {

class ReconstructRuns : public testing::Test {
 protected:
  /// Runs with a report; returns it as JSON.
  nlohmann::json reported(std::vector<std::string> arguments) const {
    const std::string file = folder.file("report.json");
    arguments.insert(arguments.begin(), "reconstruct");
    arguments.insert(arguments.end(), {"-o", mesh, "--report", file, "--quiet"});
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? nlohmann::json::parse(read_file(file)) : nlohmann::json();
  }
  void refused(std::vector<std::string> arguments, const std::string& what) const {
    arguments.insert(arguments.begin(), {"reconstruct", "--quiet"});
    arguments.insert(arguments.end(), {"-o", mesh});
    expect_refused(arguments, what);
    EXPECT_FALSE(std::filesystem::exists(mesh));
  }

  TemporaryFolder folder;
  std::string mesh = folder.file("mesh.ply");
};

}  // namespace soapfilm::test
