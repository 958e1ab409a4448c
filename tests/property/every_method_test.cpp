// What holds for every method: bytes, the memory plan, the report (cancelling: cancel_test.cpp).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "property/each_method.h"
#include "soapfilm/core/names.h"
#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/memory_plan.h"
#include "support/hash.h"
#include "support/sanitized.h"
#include "tools/evaluate/check_result.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;
using nlohmann::json;

class EveryMethod : public testing::TestWithParam<Method> {
 protected:
  static constexpr int vertices = sanitized ? 40 : resolution;
  const PointCloud cloud = range_scans({}, vertices);
  ReconstructParams params = params_of(GetParam());
  void SetUp() override { params.place.resolution = vertices; }
};

TEST_P(EveryMethod, GivesTheSameBytesForAnyNumberOfThreads) {
  const Reconstruction one = reconstructed(cloud, params, 1), three = reconstructed(cloud, params, 3);
  EXPECT_GT(one.mesh.triangles.size(), 1000u);
  EXPECT_EQ(hash_mesh(one.mesh), hash_mesh(three.mesh));
  EXPECT_EQ(one.report.certificate.binary.primal, three.report.certificate.binary.primal);
}

/// tv plans again once the surface is known; a limit that only just holds the samples is refused before the work.
TEST_P(EveryMethod, IsRefusedBeforeItsWorkWhenThePlanPassesTheLimit) {
  const size_t planned = reconstructed(cloud, params).report.planned_bytes;
  Context context(1);
  context.limit_memory(planned);
  EXPECT_NO_THROW(reconstruct(cloud, params, context));
  context.limit_memory(planned - 1);
  EXPECT_THROW(reconstruct(cloud, params, context), MemoryError);
  StageList stages;
  Context listed(1, stages);
  listed.limit_memory(GetParam() == Method::tv ? plan_placing(cloud) : planned - 1);
  EXPECT_THROW(reconstruct(cloud, params, listed), MemoryError);
  EXPECT_EQ(stages.names, (std::vector<std::string>{"orient", "place"}));
}

TEST_P(EveryMethod, ReportsWhatItDid) {
  Reconstruction result = reconstructed(cloud, params);
  check_result(result, cloud, Context(1));
  const json report = json::parse(to_json(result.report));
  const std::string name = name_of(GetParam());
  EXPECT_EQ(report["method"]["name"], name);
  EXPECT_EQ(report["parameters"]["solve"]["method"], name);
  EXPECT_EQ(report["mesh"]["triangles"], result.mesh.triangles.size());
  EXPECT_EQ(report["mesh"]["closed"], true);
  EXPECT_TRUE(report["cross_validation"].is_null());
  EXPECT_GT(report["memory"]["planned_bytes"].get<size_t>(), 1u << 20);
  const json& certificate = report["certificate"];
  EXPECT_EQ(certificate.is_null(), GetParam() == Method::vrip);
  if (GetParam() == Method::vrip) return;
  EXPECT_GT(report["grid"]["inside"].get<size_t>(), 10000u);
  EXPECT_LT(certificate["primal_binary"].get<double>(), 0);
  EXPECT_GT(certificate["total_variation_binary"].get<double>(), 1000);
  const bool bounded = GetParam() == Method::tv || GetParam() == Method::tv_sor;
  for (const char* key : {"dual", "gap_binary", "relative_gap_binary"})
    EXPECT_EQ(certificate[key].is_number(), bounded) << key << " is a number or null";
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         testing::Values(Method::tv, Method::tv_sor, Method::poisson, Method::graph_cut_6,
                                         Method::graph_cut_26, Method::vrip),
                         method_name);

json method_section(Method method) {
  return json::parse(to_json(reconstructed(range_scans(), params_of(method)).report))["method"];
}

/// Levels that only give the next one its start need not converge, and cause no warning.
TEST(MethodReport, WarnsOfTheLevelsThatStoppedTooEarly) {
  ReconstructParams params = params_of(Method::tv);
  params.place.resolution = 64;
  params.place.levels = 6;
  params.energy.lambda = 0.05;
  params.solve.max_iterations = 1;
  params.surface.refine = false;
  const ReconstructReport report = reconstructed(sampled("sphere", 64, 1), params).report;
  std::vector<std::string> expected;
  for (const LevelReport& level : report.details->solve.levels) {
    EXPECT_FALSE(level.converged) << level.level;
    if (level.lambda_share == 1)
      expected.push_back(fmt::format("level {}: not converged after 1 iterations", level.level));
  }
  ASSERT_GE(expected.size(), 2u);
  ASSERT_LT(expected.size(), report.details->solve.levels.size());
  // After a single iteration most of the mesh is far from the samples, which is the last warning.
  ASSERT_EQ(report.warnings.size(), expected.size() + 1);
  EXPECT_NE(report.warnings.back().find("it closes what was not scanned"), std::string::npos) << report.warnings.back();
  for (size_t k = 0; k < expected.size(); ++k)
    EXPECT_TRUE(report.warnings[k].starts_with(expected[k])) << report.warnings[k];
}

TEST(MethodReport, SorHasTheEnergyOfEveryIteration) {
  const json levels = method_section(Method::tv_sor)["levels"];
  ASSERT_EQ(levels.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(levels[k]["level"], 2 - k);
    const auto iterations = levels[k]["iterations"].get<size_t>();
    EXPECT_GT(iterations, 1u);
    EXPECT_EQ(levels[k]["energy"].size(), iterations + 1);
    EXPECT_EQ(levels[k]["seconds"].size(), iterations + 1);
    EXPECT_LT(levels[k]["energy"].back(), levels[k]["energy"].front());
  }
  EXPECT_GT(levels.back()["bytes"].get<size_t>(), 4u * 44 * 44 * 44);
}

TEST(MethodReport, PoissonHasItsResiduals) {
  const json section = method_section(Method::poisson);
  EXPECT_EQ(section["converged"], true);
  EXPECT_LE(section["residual"].get<double>(), PoissonParams().tolerance);
  EXPECT_EQ(section["residuals"].size(), section["iterations"].get<size_t>());
  EXPECT_LT(section["energy"].get<double>(), 0);
  EXPECT_GT(section["unknowns"].get<size_t>(), size_t{44} * 44 * 44);
}

TEST(MethodReport, GraphCutHasItsGraph) {
  const json six = method_section(Method::graph_cut_6), all = method_section(Method::graph_cut_26);
  EXPECT_EQ(six["globally_optimal"], true);
  EXPECT_LT(six["energy"].get<double>(), 0);
  EXPECT_GT(six["links"].get<size_t>(), 2 * six["vertices"].get<size_t>());
  EXPECT_GT(all["links"].get<size_t>(), 3 * six["links"].get<size_t>());
  EXPECT_GT(all["graph_bytes"].get<size_t>(), 2 * six["graph_bytes"].get<size_t>());
}

TEST(MethodReport, VripHasItsRangeSurfaces) {
  const PointCloud cloud = range_scans();
  const ReconstructReport report = reconstructed(cloud, params_of(Method::vrip)).report;
  ASSERT_TRUE(report.details->vrip);
  EXPECT_EQ(report.details->vrip->scans, cloud.scans.size());
  EXPECT_GT(report.details->vrip->triangles, cloud.size());
  EXPECT_GT(report.details->vrip->vertices_seen, 1000u);
  EXPECT_FALSE(report.details->solve.poisson || report.details->solve.graph_cut || !report.details->solve.sor.empty() ||
               !report.details->solve.levels.empty());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
