#include "soapfilm/finish/vertex_gap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

const Context one_thread(1), three_threads(3);

/// A grid with holes, where a field of gaps lies, and points in and around it.
struct Gaps {
  Lattice lattice;
  GapField field;
  Mesh mesh;

  Gaps() {
    Box3d box;
    box.extend(Vec3d{0, 0, 0});
    box.extend(Vec3d{3, 2, 1});
    lattice = place_lattice(box, 0.05, 6);
    BrickMask active(lattice.box(0).bricks);
    Random random(5);
    BrickMask::whole(active.bricks()).for_each([&](Vec3i b) { active.set(b, random.uniform() < 0.7); });
    set_grid(active);
    for (int i = 0; i < 2000; ++i)
      mesh.vertices.push_back({random.uniform(-0.5, 3.5), random.uniform(-0.5, 2.5), random.uniform(-0.5, 1.5)});
  }
  bool is_beside(Vec3i v) const {
    const int32_t brick = field.grid.find(brick_of(v));
    return brick >= 0 && field.beside[static_cast<size_t>(brick)].test(v.x & 7, v.y & 7, v.z & 7);
  }
  void set_grid(const BrickMask& active) {
    field.grid = BrickGrid(active, one_thread);
    field.gap = Field<float>(field.grid);
    field.beside.assign(field.grid.size(), BrickBits::full());
  }
  float at(Vec3i v) const {
    const int32_t brick = field.grid.find(brick_of(v));
    return brick < 0 ? 0 : field.gap.brick(static_cast<size_t>(brick))[brick_offset(v.x & 7, v.y & 7, v.z & 7)];
  }
};

TEST(VertexGap, IsTheSumUnderATent) {
  Gaps gaps;
  Random random(6);
  for (size_t b = 0; b < gaps.field.grid.size(); ++b)
    for (int v = 0; v < brick_volume; ++v) gaps.field.gap.brick(b)[v] = static_cast<float>(random.uniform());
  for (size_t b = 0; b < gaps.field.grid.size(); b += 2) gaps.field.beside[b] = {};
  const std::vector<float> found = vertex_gap(gaps.mesh, gaps.field, gaps.lattice, one_thread);
  ASSERT_EQ(found.size(), gaps.mesh.vertices.size());
  const auto tent = [](double d) { return std::max(0.0, 1 - std::abs(d) / 2); };
  for (size_t v = 0; v < found.size(); ++v) {
    const Vec3d at = gaps.lattice.to_lattice(gaps.mesh.vertices[v]);
    double sum = 0;
    bool near = false;
    for (int z = -3; z <= 3; ++z)
      for (int y = -3; y <= 3; ++y)
        for (int x = -3; x <= 3; ++x) {
          const Vec3i g{static_cast<int>(std::floor(at.x)) + x, static_cast<int>(std::floor(at.y)) + y,
                        static_cast<int>(std::floor(at.z)) + z};
          const double weight = tent(g.x - at.x) * tent(g.y - at.y) * tent(g.z - at.z);
          sum += weight * double{gaps.at(g)};
          near = near || (weight > 0 && gaps.is_beside(g));
        }
    EXPECT_EQ(std::isnan(found[v]), !near) << "the mesh has left the surface";
    if (near) {
      EXPECT_NEAR(found[v], sum / 4, 1e-5);
    }
  }
  const std::vector<float> same = vertex_gap(gaps.mesh, gaps.field, gaps.lattice, three_threads);
  EXPECT_EQ(std::memcmp(same.data(), found.data(), found.size() * sizeof(float)), 0);
}

TEST(VertexGap, OfAPlaneIsItsGapPerArea) {
  Gaps gaps;
  gaps.set_grid(BrickMask::whole(gaps.lattice.box(0).bricks));
  constexpr int height = 17;
  for (size_t b = 0; b < gaps.field.grid.size(); ++b)
    for (int v = 0; v < brick_volume; ++v)
      if (gaps.field.grid.first_vertex(b).z + v / brick_area == height) gaps.field.gap.brick(b)[v] = 0.25f;
  Mesh on_plane;
  for (const double x : {20.0, 20.3, 21.9}) on_plane.vertices.push_back(gaps.lattice.to_world({x, 1.2 * x, height}));
  for (const float gap : vertex_gap(on_plane, gaps.field, gaps.lattice, one_thread)) EXPECT_NEAR(gap, 0.25, 1e-6);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
