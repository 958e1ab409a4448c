// Levels that adapt to the samples' density.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/details.h"
#include "support/sanitized.h"
#include "tools/mesh/self_intersection.h"

namespace soapfilm {
namespace TEST_FILE {

/// A unit ball whose density falls by `decades` powers of ten from one pole to the other.
PointCloud uneven_ball(size_t samples, double decades) {
  Random random(1);
  PointCloud cloud;
  while (cloud.size() < samples) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    const Vec3d p = normalized(Vec3d{x, y, z});
    if (random.uniform() >= std::pow(10, -decades * (1 - p.z) / 2)) continue;
    cloud.positions.push_back(p);
    cloud.normals.push_back(Vec3f(p));
  }
  return cloud;
}

double carved_radius(Vec3d p) { return 1 + 0.012 * std::sin(40 * p.x) * std::sin(40 * p.y); }

struct Errors {
  double mean = 0, most = 0;  ///< of the vertices, voxels
};
Errors errors_of(const Reconstruction& result) {
  Errors errors;
  for (const Vec3d p : result.mesh.vertices) {
    const double error = std::abs(norm(p) - 1) / result.report.grid.voxel;
    errors.mean += error / static_cast<double>(result.mesh.vertices.size());
    errors.most = std::max(errors.most, error);
  }
  return errors;
}

Reconstruction reconstructed(const PointCloud& cloud, bool adapt, int threads = 2) {
  ReconstructParams params;
  params.place.adapt = adapt;
  return reconstruct(cloud, params, Context(threads));
}

/// A thousand to one: a voxel that suits the dense pole is far too small for the other one.
TEST(Adapt, ABallOfUnevenDensityIsWholeAndRound) {
  const PointCloud cloud = test::sanitized ? uneven_ball(8000, 2) : uneven_ball(60000, 3);
  const Reconstruction even = reconstructed(cloud, false), adapted = reconstructed(cloud, true);
  const TopologyReport topology = check_topology(adapted.mesh);
  EXPECT_TRUE(topology.closed() && topology.manifold());
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_EQ(count_self_intersections(adapted.mesh, Context(1)), 0u);
  const Errors before = errors_of(even), after = errors_of(adapted);
  EXPECT_LT(after.mean, 0.02);
  EXPECT_LT(after.most, 2);
  if (!test::sanitized) {
    EXPECT_GT(before.most, 4);
  }
  EXPECT_LT(adapted.mesh.triangles.size(),
            (test::sanitized ? 1 : 0.9) * static_cast<double>(even.mesh.triangles.size()));
}

const std::vector<float>& attribute(const Mesh& mesh, const std::string& name) {
  for (const Column& a : mesh.attributes)
    if (a.name == name) return a.values;
  throw std::out_of_range(name);
}

/// The mean of an attribute over the vertices of a zone.
double mean_over(const Mesh& mesh, const std::vector<float>& values, double low, double high) {
  double sum = 0, count = 0;
  for (size_t v = 0; v < values.size(); ++v) {
    if (mesh.vertices[v].z < low || mesh.vertices[v].z > high || std::isnan(values[v])) continue;
    sum += static_cast<double>(values[v]);
    ++count;
  }
  return sum / count;
}

/// What was decided is on the vertices: triangles have the size of their level, levels follow the spacing.
TEST(Adapt, LevelsAndSpacingsAreOnTheVertices) {
  const double decades = 2;
  const PointCloud cloud = uneven_ball(8000, decades);
  const Reconstruction result = reconstructed(cloud, true);
  const Mesh& mesh = result.mesh;
  const std::vector<float>&levels = attribute(mesh, "level"), &spacings = attribute(mesh, "spacing");
  const double finest = *std::min_element(levels.begin(), levels.end());
  EXPECT_EQ(finest, 0);
  EXPECT_LT(mean_over(mesh, levels, 0.9, 2), 0.6);
  EXPECT_GT(mean_over(mesh, levels, -2, -0.9), mean_over(mesh, levels, 0.9, 2) + 0.9);
  const double voxel = result.report.details->leaf_voxel;
  std::vector<double> lengths(5), counts(5);
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      if (levels[a] != levels[b]) continue;
      lengths.at(static_cast<size_t>(levels[a])) += norm(mesh.vertices[b] - mesh.vertices[a]);
      ++counts[static_cast<size_t>(levels[a])];
    }
  for (size_t l = 0; l < counts.size(); ++l) {
    if (counts[l] < 100) continue;
    SCOPED_TRACE(l);
    EXPECT_NEAR(lengths[l] / counts[l] / std::ldexp(voxel, static_cast<int>(l)), 0.85, 0.25);
  }
  const double ratio = mean_over(mesh, spacings, -0.8, -0.6) / mean_over(mesh, spacings, 0.6, 0.8);
  const double expected = std::pow(10, decades * 1.4 / 2 / 2);  // from 0.7 to -0.7; spacing is area^(1/2)
  EXPECT_GT(ratio, expected / 1.6);
  EXPECT_LT(ratio, expected * 1.6);
}

/// A unit ball with waves on its upper pole, where samples are 400 times denser than elsewhere.
PointCloud carved_ball(size_t samples) {
  Random random(2);
  PointCloud cloud;
  while (cloud.size() < samples) {
    const Vec3d p = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    const bool carved = p.z > 0.94;
    if (!carved && random.uniform() > 1.0 / 400) continue;
    cloud.positions.push_back(p * (carved ? carved_radius(p) : 1.0));
    cloud.normals.push_back(Vec3f(p));  // roughly
  }
  return cloud;
}

/// Three levels and their borders, for any number of threads.
TEST(Adapt, ThreadsDoNotMatter) {
  const size_t samples = test::sanitized ? 4000 : 8000;
  for (const PointCloud& cloud : {uneven_ball(samples, 3), carved_ball(5 * samples)}) {
    const Mesh one = reconstructed(cloud, true, 1).mesh, many = reconstructed(cloud, true, 3).mesh;
    EXPECT_EQ(one.vertices, many.vertices);
    EXPECT_EQ(one.triangles, many.triangles);
  }
}

/// One proof for all levels, nearly as good as that of the grid alone.
TEST(Adapt, TheCertificateIsOfAllLevels) {
  for (const PointCloud& cloud : {uneven_ball(8000, 2), carved_ball(40000)}) {
    const ReconstructReport report = reconstructed(cloud, true).report;
    ASSERT_TRUE(report.details->of_grid);
    const Energies &all = report.certificate.binary, &grid = report.details->of_grid->binary;
    EXPECT_GE(all.gap, 0);
    EXPECT_DOUBLE_EQ(all.gap, all.primal - all.dual);
    EXPECT_LE(all.max_dual_norm, 1 + 1e-5);
    EXPECT_LT(report.certificate.relative_gap_binary(), 2 * report.details->of_grid->relative_gap_binary());
    EXPECT_NEAR(all.primal, grid.primal, 0.1 * std::abs(grid.primal));
    EXPECT_GT(report.details->gap_at_borders, 0);
    EXPECT_LE(report.details->gap_at_borders, all.gap);
  }
}

/// Nothing is coarse where nothing is sparse.
TEST(Adapt, AnEvenBallHasOneLevel) {
  const PointCloud cloud = uneven_ball(8000, 0);
  const Errors even = errors_of(reconstructed(cloud, false)), adapted = errors_of(reconstructed(cloud, true));
  EXPECT_NEAR(adapted.mean, even.mean, 0.1 * even.mean);
  EXPECT_NEAR(adapted.most, even.most, 0.3 * even.most);
}

struct Carving {
  double mean = 0;  ///< distance of its vertices from the waves along the radius
  size_t vertices = 0;
};
Carving carving_of(const Mesh& mesh) {
  Carving found;
  for (const Vec3d v : mesh.vertices) {
    const Vec3d p = normalized(v);
    if (p.z < 0.96) continue;
    found.mean += std::abs(norm(v) - carved_radius(p));
    ++found.vertices;
  }
  found.mean /= static_cast<double>(found.vertices);
  return found;
}

/// Where samples are dense voxels are finer than the one that suits the whole: detail there, at little cost.
TEST(Adapt, DenseSamplesGetFinerVoxels) {
  const PointCloud cloud = carved_ball(40000);
  const Reconstruction even = reconstructed(cloud, false), adapted = reconstructed(cloud, true);
  const Carving before = carving_of(even.mesh), after = carving_of(adapted.mesh);
  EXPECT_LT(after.mean, 0.5 * before.mean);
  EXPECT_LT(adapted.report.details->leaf_voxel, 0.6 * even.report.grid.voxel);
  EXPECT_LT(adapted.mesh.vertices.size() - after.vertices, 2 * (even.mesh.vertices.size() - before.vertices));
  const TopologyReport topology = check_topology(adapted.mesh);
  EXPECT_TRUE(topology.closed() && topology.manifold());
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_EQ(count_self_intersections(adapted.mesh, Context(1)), 0u);
}

/// A given voxel is the finest one: the grid has a multiple of it, and cells are as small as asked for.
TEST(Adapt, AGivenVoxelIsTheFinestOne) {
  const PointCloud cloud = carved_ball(40000);
  const double chosen = reconstructed(cloud, false).report.grid.voxel;
  ReconstructParams params;
  params.place.adapt = true;
  params.place.voxel = chosen / 4;
  const Reconstruction result = reconstruct(cloud, params, Context(2));
  EXPECT_NEAR(result.report.grid.voxel, chosen, 0.01 * chosen);
  EXPECT_NEAR(std::log2(result.report.grid.voxel / result.report.details->leaf_voxel),
              std::round(std::log2(result.report.grid.voxel / result.report.details->leaf_voxel)), 1e-9);
  EXPECT_LE(result.report.details->leaf_voxel, 0.3 * chosen);
  EXPECT_TRUE(check_topology(result.mesh).closed());
}

/// Where samples are nowhere that dense, a given voxel has no places: the grid's is next to the usual one.
TEST(Adapt, AVoxelFarBelowTheSpacingIsNotUsed) {
  const PointCloud cloud = uneven_ball(8000, 0);
  const double chosen = reconstructed(cloud, false).report.grid.voxel;
  ReconstructParams params;
  params.place.adapt = true;
  params.place.voxel = chosen / 6;
  const Reconstruction result = reconstruct(cloud, params, Context(2));
  EXPECT_TRUE(result.report.details->leaves.empty());
  EXPECT_GT(result.report.grid.voxel, 0.6 * chosen);
  EXPECT_LT(result.report.grid.voxel, 1.5 * chosen);
}

/// Finer levels that do not fit are left out, and the run says so.
TEST(Adapt, WithoutMemoryItStaysCoarse) {
  const PointCloud cloud = carved_ball(40000);
  ReconstructParams params;
  params.place.adapt = true;
  const Reconstruction whole = reconstruct(cloud, params, Context(1));
  params.place.adapt = false;
  const Reconstruction even = reconstruct(cloud, params, Context(1));
  params.place.adapt = true;
  params.place.voxel = whole.report.grid.voxel / 32;
  Context small(1);
  small.limit_memory(even.report.planned_bytes + (size_t{12} << 20));
  const Reconstruction result = reconstruct(cloud, params, small);
  const std::vector<std::string>& warnings = result.report.warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& text) {
    return text.find("where samples are dense: they do not fit into --memory") != std::string::npos;
  }));
}

TEST(Adapt, NeedsDistances) {
  const PointCloud cloud = uneven_ball(1000, 0);
  ReconstructParams params;
  params.place.adapt = true;
  params.surface.refine = false;
  EXPECT_THROW(reconstruct(cloud, params, Context(1)), ParameterError);
  params.surface.refine.reset();
  params.method = Method::poisson;
  EXPECT_THROW(reconstruct(cloud, params, Context(1)), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
