// The weights of samples: one of weight k counts as k samples of weight 1, in the data term, the fit, the removal of
// components and the last moves of vertices; one of weight 0 has no effect.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "property/each_method.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/sanitized.h"
#include "tools/mesh/distance.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr int vertices = sanitized ? 40 : 64;
constexpr int copies = 4;

/// A torus with noise, of which one half counts `copies` times: as copies, or by weights.
PointCloud told_often(bool by_weight) {
  PointCloud cloud = sampled("torus", vertices, 2);
  add_noise(cloud, 0.3 / (vertices - 12), 1);
  PointCloud often;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const int times = cloud.positions[i].x > 0 ? copies : 1;
    for (int k = 0; k < (by_weight ? 1 : times); ++k) {
      often.positions.push_back(cloud.positions[i]);
      often.normals.push_back(cloud.normals[i]);
      if (by_weight) often.weights.push_back(static_cast<float>(times));
    }
  }
  often.scans.push_back({"often", 0, often.size(), {}, {}, {}});
  return often;
}

/// The paper's lambda, against one vector for each sample: copies must not count as one sample seen several times. The
/// fit weights are given, as they are chosen by held-out samples: from copies they cannot be held out.
ReconstructParams params_for_weights() {
  ReconstructParams params;
  params.place.resolution = vertices;
  params.energy.lambda = 0.04;
  params.refine.smoothing = 2;
  params.refine.normals = 0.01;
  return params;
}

double farthest_apart(const Mesh& a, const Mesh& b) {
  const Context context(1);
  const double there = point_to_mesh_distance(a.vertices, b, context).maximum;
  return std::max(there, point_to_mesh_distance(b.vertices, a, context).maximum);
}

TEST(Weights, OneOfWeightKIsKOfWeightOne) {
  const ReconstructParams params = params_for_weights();
  const Reconstruction by_copies = reconstructed(told_often(false), params);
  const Reconstruction by_weights = reconstructed(told_often(true), params);
  const double voxel = by_copies.report.grid.voxel;
  EXPECT_EQ(by_weights.report.grid.voxel, voxel);
  EXPECT_NEAR(by_weights.report.certificate.binary.primal, by_copies.report.certificate.binary.primal,
              1e-5 * std::abs(by_copies.report.certificate.binary.primal));
  EXPECT_LT(farthest_apart(by_copies.mesh, by_weights.mesh), 0.02 * voxel);
  // The weights have an effect: without them the surface is elsewhere.
  PointCloud plain = told_often(true);
  plain.weights.clear();
  EXPECT_GT(farthest_apart(by_copies.mesh, reconstructed(plain, params).mesh), 0.04 * voxel);
}

TEST(Weights, ZeroIsAbsent) {
  const ReconstructParams params = params_for_weights();
  PointCloud cloud = sampled("torus", vertices, 2);
  add_noise(cloud, 0.3 / (vertices - 12), 1);
  const Reconstruction without = reconstructed(cloud, params);
  cloud.weights.assign(cloud.size(), 1);
  // Outliers inside of the box.
  Random random(3);
  const Box3d box = cloud.box();
  for (int i = 0; i < 500; ++i) {
    cloud.positions.push_back(box.lo + Vec3d{random.uniform() * box.size().x, random.uniform() * box.size().y,
                                             random.uniform() * box.size().z});
    cloud.normals.push_back({0, 0, 1});
    cloud.weights.push_back(0);
  }
  cloud.scans.back().end = cloud.size();
  EXPECT_EQ(hash_mesh(reconstructed(cloud, params).mesh), hash_mesh(without.mesh));
}

/// Samples of very small weight count little as lost: a wrong copy with a low confidence is no reason to warn.
TEST(Weights, CountInTheSelfCheck) {
  PointCloud cloud = sampled("torus", vertices, 2);
  const size_t good = cloud.size();
  for (size_t i = 0; i < good; i += 5) {
    cloud.positions.push_back(cloud.positions[i] + Vec3d(cloud.normals[i]) * (6.0 / (vertices - 12)));
    cloud.normals.push_back(cloud.normals[i]);
  }
  cloud.scans.back().end = cloud.size();
  cloud.weights.assign(good, 1);
  cloud.weights.resize(cloud.size(), 0.01f);
  const Reconstruction found = reconstructed(cloud, params_for_weights());
  EXPECT_NEAR(found.report.self_check.lost, 0.002, 0.0005);
  EXPECT_TRUE(found.report.warnings.empty()) << found.report.warnings.front();
}

/// A small component of few samples is dropped; if these weigh as much as many, it is kept.
TEST(Weights, CountInTheRemovalOfComponents) {
  PointCloud cloud = sampled("torus", vertices, 2);
  const size_t large = cloud.size();
  const PointCloud small = sample_surface(*make_sphere(), 150, 1);
  const double scale = 8.0 / (vertices - 12);
  const Box3d box = cloud.box();
  for (size_t i = 0; i < small.size(); ++i) {
    cloud.positions.push_back(box.hi + Vec3d{0.3, 0.3, 0.3} + small.positions[i] * scale);
    cloud.normals.push_back(small.normals[i]);
  }
  cloud.scans.back().end = cloud.size();
  cloud.weights.assign(cloud.size(), 1);
  ReconstructParams params = params_for_weights();
  params.energy.lambda = 0.01;
  params.components.few_samples = static_cast<int>(3 * small.size());
  params.components.min_support = 0;
  const Reconstruction without = reconstructed(cloud, params);
  EXPECT_EQ(without.report.components->objects.dropped, 1u);
  for (size_t i = large; i < cloud.size(); ++i) cloud.weights[i] = 4;
  const Reconstruction with = reconstructed(cloud, params);
  EXPECT_EQ(with.report.components->objects.dropped, 0u);
  EXPECT_EQ(with.report.components->objects.kept, 2u);
}

/// A confidence that some program wrote as a weight: 0.001 everywhere. Without a scale nothing would pay for its area.
TEST(Weights, ThatMeanSomethingElseAreScaledAndSaidSo) {
  ReconstructParams params;
  params.place.resolution = vertices;
  PointCloud cloud = sampled("torus", vertices, 2);
  cloud.weights.assign(cloud.size(), 1);
  const Reconstruction ones = reconstructed(cloud, params);
  EXPECT_TRUE(ones.report.warnings.empty());
  for (const float weight : {0.001f, 4096.0f, 1e-30f}) {
    cloud.weights.assign(cloud.size(), weight);
    const Reconstruction found = reconstructed(cloud, params);
    EXPECT_EQ(hash_mesh(found.mesh), hash_mesh(ones.mesh)) << weight;
    ASSERT_EQ(found.report.warnings.size(), 1u);
    EXPECT_NE(found.report.warnings[0].find("weights"), std::string::npos);
  }
}

TEST(Weights, BeyondAllOthersAreRefused) {
  ReconstructParams params = params_for_weights();
  PointCloud cloud = sampled("sphere", vertices, 1);
  for (const float bad :
       {3.4e38f, 2e6f, -1.0f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    cloud.weights.assign(cloud.size(), 1);
    cloud.weights[17] = bad;
    for (const Method method : {Method::tv, Method::graph_cut_6}) {
      params = {};
      params.place.resolution = vertices;
      params.method = method;
      EXPECT_THROW(reconstructed(cloud, params), SamplesError) << bad;
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
