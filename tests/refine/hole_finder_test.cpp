#include "soapfilm/refine/holes/hole_finder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "refine/band_support.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

using Vertices = std::set<std::tuple<int, int, int>>;
Vertices set_of(const HoleSurface& surface) {
  Vertices set;
  for (const Vec3i v : surface) set.insert({v.x, v.y, v.z});
  return set;
}

/// A sphere without the samples in some caps: `axis` times the cosine of the cap's half angle.
struct Holed {
  Labels labels;
  GridSamples samples;
  Start start;

  Holed(std::vector<std::pair<Vec3d, double>> caps, int resolution, double outliers = 0) {
    Solved solved("sphere", resolution);
    PointCloud cloud = disturbed(*solved.truth, resolution, 1, {.outliers = outliers});
    std::vector<bool> keep(cloud.size());
    for (size_t i = 0; i < cloud.size(); ++i)
      keep[i] = std::none_of(caps.begin(), caps.end(), [&](const auto& cap) {
        return dot(normalized(cloud.positions[i]), normalized(cap.first)) > cap.second;
      });
    cloud.filter(keep);
    const Problem problem = make_problem(cloud, solved.problem.lattice);
    labels = labels_of(solve(problem, 0.02, 1e-3).finest, 0.5f, one_thread);
    samples = problem.samples;
    start = start_from(labels, 3, one_thread);
  }

  bool in_band(Vec3d q) const {
    const Vec3i v{static_cast<int>(std::floor(q.x + 0.5)), static_cast<int>(std::floor(q.y + 0.5)),
                  static_cast<int>(std::floor(q.z + 0.5))};
    return value_at(start.band, start.phi0, v, 1e9f) < 1e8f;
  }
  /// Positions of the samples that are no outliers.
  std::vector<Vec3d> near_samples() const {
    std::vector<Vec3d> found = lattice_positions(samples);
    std::erase_if(found, [&](Vec3d q) { return !in_band(q); });
    return found;
  }
  /// Every second vertex on the surface; those of them that lie more than two voxels from all samples.
  HoleSurface surface() const {
    HoleSurface found;
    for_each_vertex(start.band, [&](Vec3i v, size_t i) {
      if (v.x % 2 == 0 && v.y % 2 == 0 && v.z % 2 == 0 && std::abs(start.phi0.data()[i]) <= 1) found.push_back(v / 2);
    });
    return found;
  }
  static bool is_near(const std::vector<Vec3d>& samples, Vec3i vertex) {
    return std::any_of(samples.begin(), samples.end(), [&](Vec3d q) { return norm(Vec3d(vertex * 2) - q) <= 2; });
  }
  /// Its parts whose vertices differ by at most one along each axis from one to the next.
  std::vector<HoleSurface> unsampled_parts() const {
    const std::vector<Vec3d> near = near_samples();
    HoleSurface left = surface();
    std::erase_if(left, [&](Vec3i v) { return is_near(near, v); });
    std::vector<HoleSurface> parts;
    while (!left.empty()) {
      HoleSurface part{left.back()};
      left.pop_back();
      for (size_t k = 0; k < part.size(); ++k) {
        const auto touches = [&](Vec3i v) {
          const Vec3i d = v - part[k];
          return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) == 1;
        };
        const auto taken = std::stable_partition(left.begin(), left.end(), [&](Vec3i v) { return !touches(v); });
        const HoleSurface more(taken, left.end());
        left.erase(taken, left.end());
        part.insert(part.end(), more.begin(), more.end());
      }
      parts.push_back(std::move(part));
    }
    return parts;
  }
  struct Found {
    std::set<Vertices> curved;
    size_t left;
  };
  Found found() const {
    HoleReport report;
    const HoleFinder finder(start, samples, one_thread);
    Found found{{}, 0};
    for (const HoleSurface& hole : finder.holes_to_curve(Context(1), report)) found.curved.insert(set_of(hole));
    found.left = report.left;
    return found;
  }
};

TEST(HoleFinder, SampledIsWhatLiesWithinTwoVoxelsOfASampleThatIsNoOutlier) {
  const Holed sphere({{{1, 2, 3}, 0.7}}, 26, 0.2);
  const HoleFinder finder(sphere.start, sphere.samples, one_thread);
  const std::vector<Vec3d> near = sphere.near_samples();
  EXPECT_LT(near.size(), sphere.samples.size() - 10) << "some are outliers";
  const Vec3i box = sphere.start.box.bricks * half_brick;
  size_t sampled = 0;
  for (int z = 0; z < box.z; ++z)
    for (int y = 0; y < box.y; ++y)
      for (int x = 0; x < box.x; ++x) {
        const bool expected = Holed::is_near(near, {x, y, z});
        ASSERT_EQ(finder.is_sampled({x, y, z}), expected) << x << " " << y << " " << z;
        sampled += expected;
      }
  EXPECT_GT(sampled, 300u);
}

/// Holes wide and narrow in all directions: what is curved is each connected part of 24 vertices or more.
TEST(HoleFinder, HolesAreTheConnectedPartsWithoutSamples) {
  const Holed sphere(
      {{{1, 2, 3}, 0.9}, {{-1, 2, -3}, 0.92}, {{-2, -1.5, 1}, 0.95}, {{3, -2, -1}, 0.98}, {{-3, 2, 1}, 0.99}}, 56);
  std::set<Vertices> expected;
  size_t small = 0;
  for (const HoleSurface& part : sphere.unsampled_parts()) {
    if (part.size() >= 24)
      expected.insert(set_of(part));
    else
      ++small;
  }
  EXPECT_GE(expected.size(), 3u);
  EXPECT_GT(small, 0u);
  const auto found = sphere.found();
  EXPECT_EQ(found.curved, expected);
  EXPECT_EQ(found.left, 0u);
}

/// Nearer than two voxels to its first or last free vertices.
TEST(HoleFinder, WhatTouchesTheBorderIsLeft) {
  const std::vector<std::pair<Vec3d, double>> caps{{{1, 2, 3}, 0.8}, {{-1, -2, -3}, 0.82}};
  Holed sphere(caps, 40);
  const LevelBox box = sphere.start.box;
  const auto before = sphere.found();
  ASSERT_EQ(before.curved.size(), 2u);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      // The outermost vertex of the holes along this axis, in voxels.
      int outermost = high ? -1000 : 1000;
      for (const Vertices& hole : before.curved)
        for (const auto& [x, y, z] : hole) {
          const int at = 2 * Vec3i{x, y, z}[axis];
          outermost = high ? std::max(outermost, at) : std::min(outermost, at);
        }
      for (const int distance : {1, 2}) {
        sphere.start.box = box;
        (high ? sphere.start.box.free_hi : sphere.start.box.free_lo)[axis] = outermost + (high ? distance : -distance);
        const auto found = sphere.found();
        EXPECT_EQ(found.left, distance < 2 ? 1u : 0u) << axis << high << distance;
        EXPECT_EQ(found.curved.size(), distance < 2 ? 1u : 2u);
      }
    }
}

TEST(HoleFinder, WhatIsMoreThanAFifthOfTheSurfaceIsLeft) {
  for (const double cosine : {0.6, 0.45, 0.3, 0.2}) {
    const Holed sphere({{{1, 2, 3}, cosine}}, 36);
    const auto parts = sphere.unsampled_parts();
    size_t largest = 0;
    for (const HoleSurface& part : parts) largest = std::max(largest, part.size());
    const double share = static_cast<double>(largest) / static_cast<double>(sphere.surface().size());
    const auto found = sphere.found();
    EXPECT_EQ(found.left, share > 0.2 ? 1u : 0u);
    EXPECT_EQ(found.curved.size(), share > 0.2 ? 0u : 1u);
  }
}

/// A cap cut off along a face of the samples' box is an unseen base where the surface around meets it steeply.
TEST(HoleFinder, ABaseIsLeft) {
  constexpr double half = 0.5, shallow = 0.8;  // the sphere meets the cut at 60 and 37 degrees
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Vec3d pole;
      pole[axis] = side;
      EXPECT_EQ(Holed({{pole, half}}, 36).found().left, 1u) << axis << " " << side;
      EXPECT_EQ(Holed({{pole, shallow}}, 36).found().curved.size(), 1u) << axis << " " << side;
    }
  EXPECT_EQ(Holed({{{1, 2, 3}, half}}, 36).found().curved.size(), 1u) << "along no face";
}

}  // namespace TEST_FILE
}  // namespace soapfilm
