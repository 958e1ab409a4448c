// Every method through the one call: what its surface promises, and what one judge says of all of them on the same
// grid, from the same data, with the same weight of area.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "soapfilm/core/error.h"
#include "soapfilm/evaluate/topology.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/scanner/virtual_scan.h"
#include "support/hash.h"
#include "support/problem.h"

namespace soapfilm {
namespace {

using namespace test;
using nlohmann::json;

constexpr int resolution = 56;
constexpr double density = 2;  // samples per voxel^2

const std::vector<Method> segmenting = {Method::tv, Method::tv_sor, Method::poisson, Method::graph_cut_6,
                                        Method::graph_cut_26};
const std::vector<std::string> shapes = {"sphere", "torus", "sheets"};

ReconstructParams params_of(Method method) {
  ReconstructParams params;
  params.method = method;
  params.place.resolution = resolution;
  return params;
}

Reconstruction reconstructed(const PointCloud& cloud, const ReconstructParams& params, int threads = 1) {
  Progress progress;
  return reconstruct(cloud, params, Parallel(threads), progress);
}

Reconstruction reconstructed(const std::string& shape, Method method) {
  return reconstructed(sampled(shape, resolution, density), params_of(method));
}

/// A sphere of diameter 1 as range scans: one for each scanner position, all round without any.
PointCloud range_scans(const std::vector<Vec3d>& positions = {}) {
  ScannerParams scanner;
  scanner.step = 1.0 / (resolution - 12);
  scanner.positions = positions;
  return virtual_scan(*make_sphere(), scanner, Parallel(1)).cloud;
}

std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

struct Case {
  std::string shape;
  Method method;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.shape << " by " << name_of(c.method); }

std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (const std::string& shape : shapes)
    for (const Method method : segmenting) all.push_back({shape, method});
  return all;
}

class Segmenting : public testing::TestWithParam<Case> {};

TEST_P(Segmenting, GivesAWatertightMeshWithTheShapesComponentsAndGenus) {
  const auto& [name, method] = GetParam();
  const auto shape = make_shape(name);
  const Reconstruction result = reconstructed(name, method);
  const TopologyReport topology = check_topology(result.mesh);
  EXPECT_TRUE(topology.watertight()) << summary(topology);
  EXPECT_EQ(topology.components.size(), static_cast<size_t>(shape->facts().components));
  EXPECT_EQ(topology.genus(), shape->facts().genus);
  const double volume = *shape->volume();
  EXPECT_NEAR(result.mesh.volume(), volume, 0.04 * volume);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Segmenting, testing::ValuesIn(all_cases()),
                         [](const auto& c) { return c.param.shape + "_" + identifier(name_of(c.param.method)); });

class OneJudge : public testing::TestWithParam<std::string> {};

/// E of the binary labels that each method draws, by the energy that tv minimises: none may lie below tv's bound, and
/// tv's own lies so near to it that the bound says something.
TEST_P(OneJudge, NoMethodIsBelowTheBoundThatTvProvesSlow) {
  const Certificate tv = reconstructed(GetParam(), Method::tv).report.certificate;
  const double bound = tv.relaxed.dual, scale = std::abs(bound);
  ASSERT_LT(bound, 0);
  EXPECT_LT(tv.binary.primal - bound, 0.01 * scale);
  for (const Method method : segmenting) {
    const Certificate c = reconstructed(GetParam(), method).report.certificate;
    EXPECT_EQ(c.lambda, tv.lambda) << name_of(method);
    EXPECT_GE(c.binary.primal, bound) << name_of(method);
    EXPECT_LT(c.binary.primal, 0.7 * bound) << name_of(method) << ": lost more than a rival's different aim explains";
  }
}

/// The paper's numerics and ours, side by side: the same energy within 2 %, and two bounds of the same optimum.
TEST_P(OneJudge, TheSorOfThePaperAndTvAgree) {
  const Certificate tv = reconstructed(GetParam(), Method::tv).report.certificate;
  const Certificate sor = reconstructed(GetParam(), Method::tv_sor).report.certificate;
  EXPECT_NEAR(sor.binary.primal, tv.binary.primal, 0.02 * std::abs(tv.binary.primal));
  EXPECT_LE(sor.relaxed.dual, tv.relaxed.primal);
  EXPECT_LE(sor.relaxed.dual, tv.binary.primal);
  EXPECT_LE(tv.relaxed.dual, sor.relaxed.primal);
  EXPECT_LE(sor.relaxed.dual, sor.relaxed.primal);
  EXPECT_NEAR(sor.relaxed.dual, tv.relaxed.dual, 0.1 * std::abs(tv.relaxed.dual)) << "a bound that says something";
}

/// With the norm along the axes the coarea formula is exact: the convex problem and the cut have the same minimum.
TEST_P(OneJudge, AnisotropicTvAndTheCutReachTheSameEnergy) {
  const PointCloud cloud = sampled(GetParam(), resolution, density);
  ReconstructParams params = params_of(Method::tv);
  params.energy.norm = Norm::anisotropic;
  params.solve.tolerance = 1e-6;
  params.solve.max_iterations = 20000;
  const ReconstructReport tv = reconstructed(cloud, params).report;
  params.method = Method::graph_cut_6;
  const ReconstructReport cut = reconstructed(cloud, params).report;
  ASSERT_TRUE(cut.graph_cut->globally_optimal);
  const double energy = cut.certificate.binary.primal;
  EXPECT_NEAR(tv.certificate.binary.primal, energy, 1e-5 * std::abs(energy));
  EXPECT_NEAR(cut.graph_cut->energy, energy, 1e-5 * std::abs(energy)) << "the cut's own sum and the judge's";
  EXPECT_LE(tv.certificate.relaxed.dual, energy + 1e-12 * std::abs(energy)) << "a bound, to the rounding of double";
}

INSTANTIATE_TEST_SUITE_P(Shapes, OneJudge, testing::ValuesIn(shapes), [](const auto& s) { return s.param; });

class EveryMethod : public testing::TestWithParam<Method> {
 protected:
  const PointCloud cloud = range_scans();
  ReconstructParams params = params_of(GetParam());
};

TEST_P(EveryMethod, GivesTheSameBytesForAnyNumberOfThreads) {
  const Reconstruction one = reconstructed(cloud, params, 1), three = reconstructed(cloud, params, 3);
  EXPECT_GT(one.mesh.triangles.size(), 1000u);
  EXPECT_EQ(hash_mesh(one.mesh), hash_mesh(three.mesh));
  EXPECT_EQ(one.report.certificate.binary.primal, three.report.certificate.binary.primal);
}

/// Remembers which stages began.
struct StageList : Progress {
  void begin_stage(std::string_view name) override { names.emplace_back(name); }
  std::vector<std::string> names;
};

TEST_P(EveryMethod, IsRefusedBeforeItsWorkWhenThePlanPassesTheLimit) {
  const size_t planned = reconstructed(cloud, params).report.planned_bytes;
  params.memory_limit = planned;
  EXPECT_NO_THROW(reconstructed(cloud, params));
  params.memory_limit = planned - 1;
  StageList stages;
  EXPECT_THROW(reconstruct(cloud, params, Parallel(1), stages), MemoryError);
  EXPECT_EQ(stages.names, (std::vector<std::string>{"orient", "place"}));
}

TEST_P(EveryMethod, CanBeCancelled) {
  struct CancelsInStage : Progress {
    explicit CancelsInStage(std::string_view name) : stage(name) {}
    void begin_stage(std::string_view name) override {
      if (name == stage) cancel();
    }
    std::string stage;
  } progress(GetParam() == Method::vrip ? "fuse" : "solve");
  EXPECT_THROW(reconstruct(cloud, params, Parallel(1), progress), Cancelled);
}

TEST_P(EveryMethod, TellsWhatItDid) {
  Reconstruction result = reconstructed(cloud, params);
  check_result(result, cloud, Parallel(1));
  const json report = json::parse(to_json(result.report));
  const std::string name = name_of(GetParam());
  EXPECT_EQ(report["method"]["name"], name);
  EXPECT_EQ(report["parameters"]["solve"]["method"], name);
  EXPECT_EQ(report["mesh"]["triangles"], result.mesh.triangles.size());
  EXPECT_EQ(report["mesh"]["closed"], true);
  EXPECT_TRUE(report["select"].is_null());
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

std::string method_name(const testing::TestParamInfo<Method>& info) { return identifier(name_of(info.param)); }

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         testing::Values(Method::tv, Method::tv_sor, Method::poisson, Method::graph_cut_6,
                                         Method::graph_cut_26, Method::vrip),
                         method_name);

json method_section(Method method) {
  return json::parse(to_json(reconstructed(range_scans(), params_of(method)).report))["method"];
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
  ASSERT_TRUE(report.vrip);
  EXPECT_EQ(report.vrip->scans, cloud.scans.size());
  EXPECT_GT(report.vrip->triangles, cloud.size());
  EXPECT_GT(report.vrip->vertices_seen, 1000u);
  EXPECT_FALSE(report.poisson || report.graph_cut || !report.sor.empty() || !report.levels.empty());
}

TEST(Vrip, IsOpenWhereNothingWasSeenAndClosedAllRound) {
  const Mesh half = reconstructed(range_scans({{5, 0, 0}}), params_of(Method::vrip)).mesh;
  EXPECT_FALSE(check_topology(half).closed());
  EXPECT_TRUE(check_topology(half).manifold()) << summary(check_topology(half));
  const Mesh whole = reconstructed(range_scans(), params_of(Method::vrip)).mesh;
  EXPECT_TRUE(check_topology(whole).watertight()) << summary(check_topology(whole));
  EXPECT_LT(half.area(), 0.6 * whole.area());
  // tv closes the half that was not seen.
  EXPECT_TRUE(check_topology(reconstructed(range_scans({{5, 0, 0}}), params_of(Method::tv)).mesh).watertight());
}

std::string refusal(const PointCloud& cloud, const ReconstructParams& params) {
  StageList stages;
  try {
    reconstruct(cloud, params, Parallel(1), stages);
  } catch (const ParameterError& error) {
    EXPECT_TRUE(stages.names.empty()) << "refused before the work";
    return error.what();
  }
  return "nothing was refused";
}

TEST(Vrip, RefusesWhatIsNoRangeScanBeforeTheWork) {
  PointCloud cloud = range_scans();
  cloud.scans[1].name = "second";
  const RangeGrid grid = *cloud.scans[1].range_grid;
  cloud.scans[1].range_grid.reset();
  EXPECT_EQ(refusal(cloud, params_of(Method::vrip)), "vrip needs range scans: scan \"second\" has no range grid");
  cloud.scans[1].range_grid = grid;
  cloud.scans[1].sensor.reset();
  EXPECT_EQ(refusal(cloud, params_of(Method::vrip)),
            "vrip needs range scans: scan \"second\" has no sensor position and no viewing direction");
}

TEST(Vrip, ThatSawNoWholeCellIsAnEmptyResult) {
  ReconstructParams params = params_of(Method::vrip);
  params.place.resolution.reset();
  params.place.voxel = 50;
  EXPECT_THROW(reconstructed(range_scans({{5, 0, 0}}), params), EmptyResult);
}

/// poisson's surface owes nothing to lambda: one at which no film pays must not make it an empty result.
TEST(Poisson, HasTheSameSurfaceForEveryLambda) {
  const PointCloud cloud = sampled("sphere", resolution, 1);
  ReconstructParams params = params_of(Method::poisson);
  const Reconstruction usual = reconstructed(cloud, params);
  EXPECT_TRUE(usual.report.warnings.empty());
  params.energy.lambda = 4;
  const Reconstruction heavy = reconstructed(cloud, params);
  EXPECT_GT(heavy.report.certificate.binary.primal, 0);
  EXPECT_TRUE(heavy.report.warnings.empty()) << heavy.report.warnings.front();
  EXPECT_EQ(heavy.mesh.triangles.size(), usual.mesh.triangles.size());
  EXPECT_NEAR(heavy.mesh.volume(), usual.mesh.volume(), 1e-4 * usual.mesh.volume());
}

TEST(Poisson, SaysSoWhenTheDirectionsPointInward) {
  PointCloud cloud = sampled("sphere", resolution, 1);
  for (Vec3f& n : cloud.normals) n = n * -1.0f;
  Progress progress;
  std::string message;
  try {
    reconstruct(cloud, params_of(Method::poisson), Parallel(1), progress);
  } catch (const ParameterError& error) {
    message = error.what();
  }
  EXPECT_EQ(message.find("poisson: the mean of u at the samples is -"), 0u) << message;
  EXPECT_NE(message.find("directions point outward"), std::string::npos) << message;
}

class EmptyBy : public testing::TestWithParam<Method> {};

/// The message's lambda is one that keeps a surface by the same method and the same norm.
TEST_P(EmptyBy, NamesALambdaThatKeepsASurfaceSlow) {
  const PointCloud cloud = sampled("sphere", 40, 1);
  ReconstructParams params = params_of(GetParam());
  params.place.resolution = 40;
  params.energy.lambda = 3;
  params.energy.norm = Norm::anisotropic;
  double largest = 0;
  try {
    reconstructed(cloud, params);
    FAIL() << "a lambda above the density left a surface";
  } catch (const EmptyResult& empty) {
    largest = empty.largest_lambda;
  }
  ASSERT_GT(largest, 0);
  params.energy.lambda = 0.93 * largest;
  EXPECT_GT(reconstructed(cloud, params).mesh.triangles.size(), 100u);
  params.energy.lambda = 1.1 * largest;
  EXPECT_THROW(reconstructed(cloud, params), EmptyResult);
}

INSTANTIATE_TEST_SUITE_P(Methods, EmptyBy, testing::Values(Method::tv, Method::graph_cut_6), method_name);

/// From u = 0 the paper's numerics stop short of a surface that still pays: then the message must not say that none
/// does.
TEST(Sor, SaysWhenItLosesASurfaceThatPaysSlow) {
  const PointCloud cloud = sampled("sphere", 40, 1);
  ReconstructParams params = params_of(Method::tv_sor);
  params.place.resolution = 40;
  params.energy.lambda = 3;
  double largest = 0;
  try {
    reconstructed(cloud, params);
    FAIL() << "a lambda above the density left a surface";
  } catch (const EmptyResult& empty) {
    largest = empty.largest_lambda;
  }
  params.energy.lambda = 0.93 * largest;
  try {
    reconstructed(cloud, params);
    FAIL() << "it found the surface: a plainer message will do";
  } catch (const EmptyResult& empty) {
    EXPECT_NE(std::string(empty.what()).find("method tv-sor found no surface with lambda"), std::string::npos)
        << empty.what();
    EXPECT_NEAR(empty.largest_lambda, largest, 0.03 * largest);
  }
  params.energy.lambda = 0.5 * largest;
  EXPECT_GT(reconstructed(cloud, params).mesh.triangles.size(), 100u);
}

TEST(AutomaticLambda, WarnsWhenTheBestMayLieBeyondTheCandidates) {
  PointCloud cloud = sampled("sphere", resolution, 1);
  ReconstructParams params = params_of(Method::tv);
  params.energy.cross_validate = true;
  params.select.folds = 2;
  params.select.max_resolution = 32;
  const auto warnings_with = [&](std::vector<double> candidates) {
    params.select.candidates = std::move(candidates);
    const ReconstructReport report = reconstructed(cloud, params).report;
    EXPECT_DOUBLE_EQ(report.certificate.lambda, report.select->chosen * report.input.density);
    for (const CrossValidationPoint& point : report.select->curve)
      EXPECT_DOUBLE_EQ(point.lambda, point.lambda_per_density * report.input.density);
    return fmt::format("{}", fmt::join(report.warnings, "\n"));
  };
  const std::string low =
      "cross-validation chose the lowest of 2 candidates, 0.02 x samples per voxel^2: a lower one "
      "may be better";
  EXPECT_EQ(warnings_with({0.02, 5}), low);
  EXPECT_EQ(warnings_with({1e-6, 0.01}),
            "cross-validation chose the highest of 2 candidates, 0.01 x samples per voxel^2: a higher one may be "
            "better");
  EXPECT_EQ(warnings_with({1e-6, 0.02, 5}), "");
  EXPECT_EQ(warnings_with({0.02}), "") << "nothing to choose";
}

}  // namespace
}  // namespace soapfilm
