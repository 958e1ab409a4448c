// Every method through the one call: the properties of its surface, and one energy for all of them on the same grid,
// from the same data, with the same weight of area.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "property/each_method.h"
#include "soapfilm/core/names.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/details.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const std::vector<Method> segmenting = {Method::tv, Method::tv_sor, Method::poisson, Method::graph_cut_6,
                                        Method::graph_cut_26};
const std::vector<std::string> shapes = {"sphere", "torus", "sheets"};

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

class SharedEnergy : public testing::TestWithParam<std::string> {};

/// E of the binary labels of each method, by the energy that tv minimizes: none may be below tv's bound, and tv's own
/// is so close to it that the bound is meaningful.
TEST_P(SharedEnergy, NoMethodIsBelowTheBoundThatTvProvesSlow) {
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

/// The paper's numerics and ours: the same energy within 2 %, and two bounds of the same optimum.
TEST_P(SharedEnergy, TheSorOfThePaperAndTvAgree) {
  const Certificate tv = reconstructed(GetParam(), Method::tv).report.certificate;
  const Certificate sor = reconstructed(GetParam(), Method::tv_sor).report.certificate;
  EXPECT_NEAR(sor.binary.primal, tv.binary.primal, 0.02 * std::abs(tv.binary.primal));
  EXPECT_LE(sor.relaxed.dual, tv.relaxed.primal);
  EXPECT_LE(sor.relaxed.dual, tv.binary.primal);
  EXPECT_LE(tv.relaxed.dual, sor.relaxed.primal);
  EXPECT_LE(sor.relaxed.dual, sor.relaxed.primal);
  EXPECT_NEAR(sor.relaxed.dual, tv.relaxed.dual, 0.1 * std::abs(tv.relaxed.dual)) << "a bound that says something";
}

/// With the anisotropic norm the coarea formula is exact: the convex problem and the cut have the same minimum.
TEST_P(SharedEnergy, AnisotropicTvAndTheCutReachTheSameEnergy) {
  const PointCloud cloud = sampled(GetParam(), resolution, density);
  ReconstructParams params = params_of(Method::tv);
  params.energy.norm = Norm::anisotropic;
  params.solve.tolerance = 1e-6;
  params.solve.max_iterations = 20000;
  const ReconstructReport tv = reconstructed(cloud, params).report;
  params.method = Method::graph_cut_6;
  const ReconstructReport cut = reconstructed(cloud, params).report;
  ASSERT_TRUE(cut.details->solve.graph_cut->globally_optimal);
  const double energy = cut.certificate.binary.primal;
  EXPECT_NEAR(tv.certificate.binary.primal, energy, 1e-5 * std::abs(energy));
  EXPECT_NEAR(cut.details->solve.graph_cut->energy, energy, 1e-5 * std::abs(energy))
      << "the cut's own sum and the judge's";
  EXPECT_LE(tv.certificate.relaxed.dual, energy + 1e-12 * std::abs(energy)) << "a bound, to the rounding of double";
}

INSTANTIATE_TEST_SUITE_P(Shapes, SharedEnergy, testing::ValuesIn(shapes), [](const auto& s) { return s.param; });

TEST(Vrip, IsOpenWhereNothingWasSeenAndClosedAllRound) {
  const Mesh half = reconstructed(range_scans({{5, 0, 0}}), params_of(Method::vrip)).mesh;
  EXPECT_FALSE(check_topology(half).closed());
  EXPECT_TRUE(check_topology(half).manifold()) << summary(check_topology(half));
  const Mesh whole = reconstructed(range_scans(), params_of(Method::vrip)).mesh;
  EXPECT_TRUE(check_topology(whole).watertight()) << summary(check_topology(whole));
  EXPECT_LT(half.area(), 0.6 * whole.area());
  // tv closes the half that was not seen, if required.
  ReconstructParams closed = params_of(Method::tv);
  closed.border.outside = Border::air;
  EXPECT_TRUE(check_topology(reconstructed(range_scans({{5, 0, 0}}), closed).mesh).watertight());
}

/// A scanner position in the parameters is used for scans that have none; nothing else of the cloud need be changed.
TEST(Vrip, ScansWithoutAPositionTakeTheOneThatIsGiven) {
  const PointCloud named = range_scans({{5, 0, 0}});
  PointCloud bare = named;
  for (Scan& scan : bare.scans) scan.sensor.reset();
  ReconstructParams params = params_of(Method::vrip);
  EXPECT_THROW(reconstructed(bare, params), ParameterError);
  params.orient.sensor = named.scans.front().sensor;
  ASSERT_TRUE(params.orient.sensor);
  const Mesh given = reconstructed(bare, params).mesh, own = reconstructed(named, params_of(Method::vrip)).mesh;
  EXPECT_EQ(given.vertices, own.vertices);
  EXPECT_EQ(given.triangles, own.triangles);
}

std::string refusal(const PointCloud& cloud, const ReconstructParams& params) {
  StageList stages;
  try {
    reconstruct(cloud, params, Context(1, stages));
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
  params.place.voxel = 0.9;
  EXPECT_THROW(reconstructed(range_scans({{5, 0, 0}}), params), EmptyResult);
}

/// poisson's surface does not depend on lambda: one for which no surface pays must not make it an empty result.
TEST(Poisson, HasTheSameSurfaceForEveryLambda) {
  const PointCloud cloud = sampled("sphere", resolution, 1);
  ReconstructParams params = params_of(Method::poisson);
  params.energy.by_area = false;  // as where lambda is given
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
  std::string message;
  try {
    reconstruct(cloud, params_of(Method::poisson), Context(1));
  } catch (const ParameterError& error) {
    message = error.what();
  }
  EXPECT_EQ(message.find("poisson: the mean of u at the samples is -"), 0u) << message;
  EXPECT_NE(message.find("directions point outward"), std::string::npos) << message;
}

class EmptyBy : public testing::TestWithParam<Method> {};

/// The lambda of the message keeps a surface with the same method and the same norm.
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

/// From u = 0 the paper's numerics stop before a surface that still pays: then the message must not say that no surface
/// pays.
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

TEST(Tv, ThatStopsBeforeItsSurfaceIsThereAsksForMoreIterations) {
  ReconstructParams params = params_of(Method::tv);
  params.place.levels = 5;
  params.energy.lambda = 0.1;
  params.solve.max_iterations = 2;
  const PointCloud cloud = sampled("sphere", resolution, 1);
  try {
    reconstructed(cloud, params);
    FAIL() << "two iterations left a surface";
  } catch (const EmptyResult& empty) {
    EXPECT_NE(std::string(empty.what()).find("method tv found no surface with lambda = 0.1, although one pays"),
              std::string::npos)
        << empty.what();
    EXPECT_TRUE(std::string(empty.what()).ends_with("a smaller lambda may help, or more iterations")) << empty.what();
    EXPECT_GT(empty.largest_lambda, 0.1);
  }
}

TEST(AutomaticLambda, WarnsWhenTheBestMayLieBeyondTheCandidates) {
  const PointCloud cloud = sampled("sphere", 32, 1);
  ReconstructParams params = params_of(Method::tv);
  params.place.resolution = 32;
  params.surface.refine = false;
  params.energy.cross_validate = true;
  params.cross_validation.folds = 2;
  params.cross_validation.max_resolution = 32;
  const auto warnings_with = [&](std::vector<double> candidates) {
    params.cross_validation.candidates = std::move(candidates);
    const ReconstructReport report = reconstructed(cloud, params).report;
    EXPECT_DOUBLE_EQ(report.certificate.lambda, report.details->select->chosen * report.input.density);
    for (const CrossValidationPoint& point : report.details->select->curve)
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

}  // namespace TEST_FILE
}  // namespace soapfilm
