// Surface that the samples around it do not face: the other half of a bubble, the back of a slab.
#include "soapfilm/finish/trim_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "finish/pillow.h"
#include "soapfilm/finish/trim.h"
#include "soapfilm/mesh/topology.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

struct Trimmed {
  Lattice lattice = pillow_lattice();
  Mesh before, after;
  TrimReport report;

  Trimmed(const Mesh& mesh, const GridSamples& samples, bool ends = true, int threads = 2) : before(mesh), after(mesh) {
    trim(after, samples, lattice, {{}, 4, ends}, Context(threads), report);
  }
  double left() const { return after.area() / before.area(); }
  /// Mean height of what is left over the pillow's middle, voxels.
  double height() const {
    double sum = 0;
    for (const Vec3d& v : after.vertices) sum += lattice.to_lattice(v).z - pillow_middle;
    return sum / static_cast<double>(after.vertices.size());
  }
};

/// Air between two films, both near to the samples of one sheet, which was seen from above alone: the lower one, whose
/// faces look up into the bubble, is the sheet; nothing faces the upper one.
TEST(TrimLevels, OfABubbleAroundASheetTheHalfThatNobodyFacesGoes) {
  const Lattice lattice = pillow_lattice();
  for (const float looks : {1.0f, -1.0f}) {
    const Trimmed t(pillow(lattice, 1.5, true), samples_on(lattice, {{0, looks}}));
    EXPECT_EQ(t.report.removed, 1u);
    EXPECT_EQ(t.report.unfaced, 1u);
    EXPECT_NEAR(t.left(), 0.5, 0.1);
    EXPECT_LT(t.height() * static_cast<double>(looks), -0.5);
    const TopologyReport topology = check_topology(t.after);
    EXPECT_TRUE(topology.manifold());
    EXPECT_FALSE(topology.closed());
    EXPECT_EQ(topology.components.size(), 1u);
  }
}

TEST(TrimLevels, TheBackThatClosesASlabGoesHoweverNear) {
  const Lattice lattice = pillow_lattice();
  for (const double thick : {1.0, 2.0, 5.0, 8.0}) {
    const Trimmed t(pillow(lattice, thick), samples_on(lattice, {{thick / 2, 1}}));
    EXPECT_EQ(t.report.removed, 1u) << thick;
    EXPECT_NEAR(t.left(), 0.5, 0.12) << thick;
    EXPECT_GT(t.height(), 0.35 * thick) << thick;
    EXPECT_TRUE(check_topology(t.after).manifold());
    EXPECT_FALSE(check_topology(t.after).closed());
  }
}

TEST(TrimLevels, BothSidesOfAThinBodyStay) {
  const Lattice lattice = pillow_lattice();
  for (const double thick : {1.0, 1.5, 2.0, 4.0}) {
    const Trimmed t(pillow(lattice, thick), samples_on(lattice, {{thick / 2, 1}, {-thick / 2, -1}}));
    EXPECT_EQ(t.report.removed, 0u) << thick;
    EXPECT_EQ(t.after.vertices, t.before.vertices) << thick;
    EXPECT_EQ(t.after.triangles, t.before.triangles) << thick;
    EXPECT_TRUE(check_topology(t.after).closed()) << thick;
  }
}

/// Where the surface does not end, sides mean nothing: only what is far goes.
TEST(TrimLevels, AClosedSurfaceKeepsWhatIsNear) {
  const Lattice lattice = pillow_lattice();
  const Trimmed t(pillow(lattice, 1.5, true), samples_on(lattice, {{0, 1}}), false);
  EXPECT_EQ(t.report.removed, 0u);
  EXPECT_EQ(t.after.triangles, t.before.triangles);
}

/// A gap in the samples of a sheet stays filled, though its back goes.
TEST(TrimLevels, AGapInASheetStaysFilled) {
  const Lattice lattice = pillow_lattice();
  const auto but_a_gap = [](double x, double y) { return std::hypot(x - 20, y - 20) > 7; };
  const Trimmed t(pillow(lattice, 4), samples_on(lattice, {{2, 1}}, but_a_gap));
  EXPECT_EQ(t.report.filled, 1u);
  EXPECT_EQ(t.report.removed, 1u);
  const bool filled = std::any_of(t.after.vertices.begin(), t.after.vertices.end(), [&](Vec3d v) {
    return norm(t.lattice.to_lattice(v) - Vec3d{30, 30, 22}) < 0.1;
  });
  EXPECT_TRUE(filled);
  EXPECT_NEAR(t.left(), 0.5, 0.1);
}

TEST(TrimLevels, AreOneOnTheLineOfTheCutAndKnowTheNearestSample) {
  const Lattice lattice = pillow_lattice();
  const Mesh mesh = pillow(lattice, 4);
  const GridSamples samples = samples_on(lattice, {{2, 1}});
  const double distance = 3 * lattice.voxel;
  const TrimLevels far = find_trim_levels(mesh, samples, lattice, distance, false, Context(1));
  EXPECT_TRUE(far.unfaced.empty() && far.nearest.empty());
  const TrimLevels faced = find_trim_levels(mesh, samples, lattice, distance, true, Context(1));
  ASSERT_EQ(faced.level.size(), mesh.vertices.size());
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3d at = lattice.to_lattice(mesh.vertices[v]) - Vec3d{pillow_edge, pillow_edge, pillow_middle};
    if (std::min({at.x, at.y, pillow_side - at.x, pillow_side - at.y}) < 5) continue;
    const bool upper = at.z > 0;
    EXPECT_EQ(faced.unfaced[v], !upper);
    EXPECT_EQ(faced.level[v] > 1, !upper);
    EXPECT_EQ(far.level[v] > 1, !upper) << "four voxels away";
    EXPECT_EQ(faced.nearest[v] == TrimLevels::none, !upper);
  }
}

TEST(TrimLevels, ThreadsDoNotMatter) {
  const Lattice lattice = pillow_lattice();
  const Mesh bubble = pillow(lattice, 1.5, true);
  const GridSamples samples = samples_on(lattice, {{0, 1}});
  const Trimmed one(bubble, samples, true, 1);
  for (const int threads : {2, 3}) {
    const Trimmed more(bubble, samples, true, threads);
    EXPECT_EQ(more.after.vertices, one.after.vertices);
    EXPECT_EQ(more.after.triangles, one.after.triangles);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
