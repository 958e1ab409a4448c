// soapfilm reconstruct: options of the surface, seen in the report.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/reconstruct_runs.h"
#include "soapfilm/io.h"
#include "support/sanitized.h"
#include "tools/scanner/missing.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

using nlohmann::json;

/// A folder with even samples of a sphere of diameter 1.
class SurfaceOptions : public ReconstructRuns {
 protected:
  SurfaceOptions() { write_points(cloud, sample_surface(*make_sphere(), 3000, 1)); }

  /// The report of a run on the sphere.
  json with(std::vector<std::string> options) const {
    options.insert(options.begin(), {cloud, "--resolution", sanitized ? "32" : "44"});
    return reported(options);
  }
  void expect_bad(const std::string& option, const std::string& value, const std::string& what) const {
    refused({cloud, option, value}, what);
  }

  std::string cloud = folder.file("cloud.ply");
};

TEST_F(SurfaceOptions, RefineOffLeavesTheSurfaceOfTheSegmentation) {
  const json on = with({}), off = with({"--refine", "off"});
  ASSERT_FALSE(on.is_null() || off.is_null());
  EXPECT_TRUE(on["parameters"]["surface"]["refine"].is_null()) << "the method decides";
  EXPECT_FALSE(on["surface"]["refine"].is_null());
  EXPECT_FALSE(on["surface"]["relax"].is_null());
  EXPECT_EQ(off["parameters"]["surface"]["refine"], false);
  EXPECT_TRUE(off["surface"]["refine"].is_null());
  EXPECT_TRUE(off["surface"]["relax"].is_null());
  EXPECT_TRUE(off["surface"]["components"].is_null()) << "dropped only before a fit";
  EXPECT_GT(off["surface"]["isovalue"].get<double>(), 0.0);
  EXPECT_EQ(off["certificate"]["primal_binary"], on["certificate"]["primal_binary"]) << "the same segmentation";
  EXPECT_LT(on["mesh"]["sample_distance"]["mean"].get<double>(), off["mesh"]["sample_distance"]["mean"].get<double>());
  const json said = with({"--refine", "on"});
  EXPECT_EQ(said["parameters"]["surface"]["refine"], true);
  EXPECT_EQ(said["surface"]["refine"], on["surface"]["refine"]);
}

TEST_F(SurfaceOptions, SmoothingIsTheOneGiven) {
  const json chosen = with({}), soft = with({"--smoothing", "0.01"}), stiff = with({"--smoothing", "300"});
  ASSERT_FALSE(chosen.is_null() || soft.is_null() || stiff.is_null());
  EXPECT_TRUE(chosen["parameters"]["refine"]["smoothing"].is_null());
  EXPECT_EQ(soft["parameters"]["refine"]["smoothing"], 0.01);
  EXPECT_EQ(soft["surface"]["refine"]["smoothing"], 0.01);
  EXPECT_EQ(stiff["surface"]["refine"]["smoothing"], 300.0);
  const auto distance = [](const json& report) { return report["mesh"]["sample_distance"]["mean"].get<double>(); };
  EXPECT_LT(distance(soft), distance(stiff));
  EXPECT_LE(distance(chosen), distance(stiff));
}

TEST_F(SurfaceOptions, BendToleranceDecidesHowManyEdgesAreSplit) {
  const json by_default = with({}), coarse = with({"--split-tolerance", "0.02"}),
             none = with({"--split-tolerance", "0"});
  ASSERT_FALSE(by_default.is_null() || coarse.is_null() || none.is_null());
  EXPECT_EQ(none["parameters"]["surface"]["split_tolerance"], 0.0);
  EXPECT_TRUE(none["surface"]["relax"].is_null());
  EXPECT_EQ(none["mesh"]["triangles"], by_default["surface"]["relax"]["triangles_before"]);
  const auto split = [](const json& report) { return report["surface"]["relax"]["split_edges"].get<int>(); };
  EXPECT_GT(split(by_default), 0);
  EXPECT_LT(split(coarse), split(by_default));
  EXPECT_GT(by_default["mesh"]["triangles"], none["mesh"]["triangles"]);
}

TEST_F(SurfaceOptions, ComponentsAreKeptWhenAsked) {
  const json dropped = with({}), kept = with({"--drop-components", "off"});
  ASSERT_FALSE(dropped.is_null() || kept.is_null());
  EXPECT_TRUE(dropped["parameters"]["surface"]["drop_components"].is_null());
  EXPECT_EQ(dropped["surface"]["components"]["objects"]["kept"], 1);
  EXPECT_EQ(kept["parameters"]["surface"]["drop_components"], false);
  EXPECT_TRUE(kept["surface"]["components"].is_null());
}

/// One half of a torus, sampled 50 times more sparsely than the other.
TEST_F(SurfaceOptions, WeightsByAreaKeepAThinlySampledHalf) {
  const auto torus = make_torus();
  PointCloud thinned = sample_surface(*torus, 58000, 1);
  thinned.filter(kept_samples(*torus, thinned, {.sparse_half = 50}, Context(1)));
  write_points(cloud, thinned);
  const std::vector<std::string> words{cloud, "--resolution", "76"};
  std::vector<std::string> off = words;
  off.insert(off.end(), {"--weights", "samples"});
  const json kept = reported(words), lost = reported(off);
  ASSERT_FALSE(kept.is_null() || lost.is_null());
  EXPECT_EQ(kept["parameters"]["energy"]["by_area"], true);
  EXPECT_EQ(kept["mesh"]["genus"], 1);
  EXPECT_EQ(lost["parameters"]["energy"]["by_area"], false);
  EXPECT_EQ(lost["mesh"]["genus"], 0);
}

TEST_F(SurfaceOptions, BadValuesAreRefusedWithTheirRange) {
  expect_bad("--refine", "maybe", "--refine = maybe, must be one of on, off");
  expect_bad("--refine", "1", "--refine = 1, must be one of on, off");
  expect_bad("--weights", "some", "--weights = some, must be one of area, samples");
  expect_bad("--drop-components", "sink", "--drop-components = sink, must be one of on, off");
  for (const char* value : {"0", "-1", "2000000", "inf", "nan"})
    expect_bad("--smoothing", value, "smoothing = " + std::string(value) + ", must be in [1e-06, 1e+06]");
  expect_bad("--smoothing", "rough", "--smoothing = rough, must be a number");
  for (const char* value : {"-0.1", "1.5", "inf", "nan"})
    expect_bad("--split-tolerance", value, "split_tolerance = " + std::string(value) + ", must be in [0, 1]");
  // As from an unset shell variable: CLI11 would take it for 0.
  expect_bad("--split-tolerance", "", "--split-tolerance: no value, must be a number");
  expect_bad("--min-support", "", "--min-support: no value, must be a number");
  expect_bad("--threads", "", "--threads: no value, must be a whole number");
  expect_bad("--refine", "", "--refine = , must be one of on, off");
  expect_bad("--min-support", "few", "--min-support = few, must be a number");
  expect_bad("--resolution", "1.5", "--resolution = 1.5, must be a whole number");
}

TEST_F(SurfaceOptions, OptionsOfARefinementThatIsOffAreRefused) {
  refused({cloud, "--refine", "off", "--smoothing", "1"}, "smoothing = 1: the surface is not refined");
  refused({cloud, "--refine", "off", "--split-tolerance", "0"}, "split_tolerance = 0: the surface is not refined");
  refused({cloud, "--refine", "on", "--method", "poisson"}, "refine = on: method poisson finds its own surface");
  refused({cloud, "--refine", "on", "--isovalue", "0.4"}, "isovalue = 0.4 and refine = on");
  refused({cloud, "--weights", "area", "--lambda", "0.1"}, "--weights: only a lambda that follows the samples");
  refused({cloud, "--drop-components", "on", "--method", "poisson"},
          "drop_components = on: method poisson finds its own surface");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
