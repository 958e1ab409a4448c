#include "soapfilm/extract/marching_cubes_table.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "dense_reference.h"
#include "soapfilm/core/random.h"
#include "soapfilm/mesh/topology.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace marching_cubes;
using test::DenseField;

using Segment = std::pair<int, int>;

bool changes_sign(int inside, int edge) {
  const int a = edge_corner(edge);
  return (inside >> a & 1) != (inside >> (a | 1 << edge_axis(edge)) & 1);
}

/// Triangle edges that no other triangle of the case runs through backwards.
std::set<Segment> border(const Case& c) {
  std::set<Segment> open;
  for (int i = 0; i < c.triangle_count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const Segment s{c.triangles[i][k], c.triangles[i][(k + 1) % 3]};
      if (open.erase({s.second, s.first}) > 0) continue;
      EXPECT_TRUE(open.insert(s).second) << "a segment twice";
    }
  }
  return open;
}

std::set<Segment> loop_segments(int inside) {
  std::set<Segment> out;
  for (const auto& loop : trace_loops(inside)) {
    for (size_t i = 0; i < loop.size(); ++i) out.insert({loop[i], loop[(i + 1) % loop.size()]});
  }
  return out;
}

bool lies_on_face(int edge, int face) {
  return edge_axis(edge) != face / 2 && (edge_corner(edge) >> face / 2 & 1) == (face & 1);
}

TEST(MarchingCubesTable, EdgesAreNumberedConsistently) {
  for (int edge = 0; edge < edge_count; ++edge) {
    const int a = edge_corner(edge);
    const int b = a | 1 << edge_axis(edge);
    EXPECT_NE(a, b);
    EXPECT_EQ(edge_between(a, b), edge);
    EXPECT_EQ(edge_between(b, a), edge);
  }
}

TEST(MarchingCubesTable, LoopsVisitEveryEdgeThatChangesSignOnce) {
  for (int inside = 0; inside < case_count; ++inside) {
    std::array<int, edge_count> visits{};
    for (const auto& loop : trace_loops(inside)) {
      EXPECT_GE(loop.size(), 3u);
      EXPECT_LE(loop.size(), static_cast<size_t>(longest_loop));
      for (const int edge : loop) ++visits[edge];
    }
    for (int edge = 0; edge < edge_count; ++edge) EXPECT_EQ(visits[edge], changes_sign(inside, edge) ? 1 : 0) << inside;
  }
}

TEST(MarchingCubesTable, TrianglesFillTheLoopsAndAgreeInOrientation) {
  for (int inside = 0; inside < case_count; ++inside) EXPECT_EQ(border(cases()[inside]), loop_segments(inside));
}

TEST(MarchingCubesTable, NoDiagonalLiesInAFace) {
  for (int inside = 0; inside < case_count; ++inside) {
    const auto loops = loop_segments(inside);
    const Case& c = cases()[inside];
    for (int i = 0; i < c.triangle_count; ++i) {
      for (int k = 0; k < 3; ++k) {
        const int a = c.triangles[i][k];
        const int b = c.triangles[i][(k + 1) % 3];
        EXPECT_TRUE(loops.count({a, b}) > 0 || loops.count({b, a}) > 0 || !share_face(a, b)) << "case " << inside;
      }
    }
  }
}

TEST(MarchingCubesTable, NeighborsDrawTheSameSegmentsBackwardsForAllFaceLabelings) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto segments_on = [axis](int inside, int side) {
      std::set<Segment> out;
      for (const Segment& s : loop_segments(inside)) {
        const int face = 2 * axis + side;
        if (!lies_on_face(s.first, face) || !lies_on_face(s.second, face)) continue;
        // Both cells name the edge by its lower corner without the face's own axis.
        const auto name = [&](int edge) { return 3 * (edge_corner(edge) & ~(1 << axis)) + edge_axis(edge); };
        out.insert(side == 0 ? Segment{name(s.first), name(s.second)} : Segment{name(s.second), name(s.first)});
      }
      return out;
    };
    const auto mask_on = [axis](int inside, int side) {
      int mask = 0;
      for (int c = 0; c < corner_count; ++c) {
        if ((c >> axis & 1) == side) mask |= (inside >> c & 1) << (c & ~(1 << axis));
      }
      return mask;
    };
    std::map<int, std::set<Segment>> expected;
    for (int inside = 0; inside < case_count; ++inside) {
      for (int side = 0; side < 2; ++side) {
        const auto [it, is_new] = expected.try_emplace(mask_on(inside, side), segments_on(inside, side));
        EXPECT_EQ(it->second, segments_on(inside, side)) << "new: " << is_new;
      }
    }
    EXPECT_EQ(expected.size(), 16u);
    for (const auto& [mask, segments] : expected) EXPECT_LE(segments.size(), 2u);
  }
}

TEST(MarchingCubesTable, AmbiguousFacesSeparateTheirInsideCorners) {
  const auto loops = trace_loops(1 << 0 | 1 << 3);  // opposite corners of the face z = 0
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_EQ(loops[0].size(), 3u);
  EXPECT_EQ(loops[1].size(), 3u);
}

TEST(MarchingCubesTable, NormalsPointFromInsideToOutside) {
  for (int corner = 0; corner < corner_count; ++corner) {
    DenseField field({2, 2, 2}, 0);
    field.at(test::corner_offset(corner)) = 1;
    const Mesh mesh = test::dense_isosurface(field, 0.5f);
    EXPECT_NEAR(mesh.volume(), 1.0 / 6, 1e-12);
  }
}

/// Closed, manifold, and with the handles and components that digital topology gives the labels.
void expect_good_surface(const DenseField& field, float isovalue) {
  const TopologyReport report = check_topology(test::dense_isosurface(field, isovalue));
  ASSERT_TRUE(report.triangles == 0 || report.watertight()) << summary(report);
  ASSERT_EQ(report.euler_characteristic(), 2 * test::euler_characteristic_of_inside(field, isovalue));
}

TEST(MarchingCubesTable, EveryIsolatedCellIsAClosedManifold) {
  for (int inside = 0; inside < case_count; ++inside) {
    for (const float background : {0.f, 1.f}) {
      DenseField field({4, 4, 4}, background);
      for (int c = 0; c < corner_count; ++c) {
        field.at(Vec3i{1, 1, 1} + test::corner_offset(c)) = static_cast<float>(inside >> c & 1);
      }
      expect_good_surface(field, 0.5f);
    }
  }
}

TEST(MarchingCubesTable, RandomLabelsAtEveryDensityGiveClosedManifolds) {
  for (uint64_t seed = 0; seed < (test::sanitized ? 300 : 3000); ++seed) {
    Random random(seed);
    DenseField field({5, 4, 6}, 0);
    const double density = random.uniform(0.05, 0.95);
    for (float& value : field.values) value = random.uniform() < density ? 1.f : 0.f;
    expect_good_surface(field, 0.5f);
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

TEST(MarchingCubesTable, NoiseVolumesGiveClosedManifolds) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    DenseField field({16, 15, 17}, 0);
    for (float& value : field.values) {
      value = static_cast<float>(random.uniform());
      if (random.uniform() < 0.05) value = 0.5f;                         // exactly the isovalue
      if (random.uniform() < 0.05) value = std::nextafter(0.5f, value);  // as close as can be
    }
    expect_good_surface(field, 0.5f);
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

/// Whether the open segment p-q passes through the triangle's inside.
bool pierces(Vec3d p, Vec3d q, Vec3d a, Vec3d b, Vec3d c) {
  const auto volume = [](Vec3d o, Vec3d u, Vec3d v, Vec3d w) { return dot(u - o, cross(v - o, w - o)); };
  if (volume(p, a, b, c) * volume(q, a, b, c) >= 0) return false;
  const double s = volume(p, q, a, b);
  const double t = volume(p, q, b, c);
  const double u = volume(p, q, c, a);
  return (s > 0 && t > 0 && u > 0) || (s < 0 && t < 0 && u < 0);
}

TEST(MarchingCubesTable, TrianglesOfACellDoNotCrossEachOther) {
  Random random(7);
  for (int inside = 0; inside < case_count; ++inside) {
    const Case& c = cases()[inside];
    for (int repeat = 0; repeat < 50; ++repeat) {
      std::array<Vec3d, edge_count> point;
      for (int e = 0; e < edge_count; ++e) {
        point[e] = Vec3d(test::corner_offset(edge_corner(e)));
        point[e][edge_axis(e)] = random.uniform(1e-3, 1 - 1e-3);
      }
      for (int i = 0; i < c.triangle_count; ++i) {
        const auto& t = c.triangles[i];
        for (int j = 0; j < c.triangle_count; ++j) {
          for (int k = 0; k < 3; ++k) {
            const int p = c.triangles[j][k];
            const int q = c.triangles[j][(k + 1) % 3];
            if (std::count(t.begin(), t.end(), p) + std::count(t.begin(), t.end(), q) > 0) continue;
            EXPECT_FALSE(pierces(point[p], point[q], point[t[0]], point[t[1]], point[t[2]])) << "case " << inside;
          }
        }
      }
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
