// A flat closed mesh around a sheet of samples: what is known of its two sides differs from test to test.
#pragma once

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm::test {

constexpr int pillow_side = 40;  // voxels
constexpr double pillow_middle = 20, pillow_edge = 10;

inline Lattice pillow_lattice() {
  Lattice lattice;
  lattice.size = {pillow_side + 20, pillow_side + 20, 40};
  lattice.voxel = 0.5;
  lattice.first_vertex = {-2, 7, 100};
  return lattice;
}

/// Two sheets of pillow_side x pillow_side squares, `thick` voxels apart, and a narrow band around them. Seen from
/// outside its faces look outward; `inside_out`: inward, as those of a bubble in solid matter do.
inline Mesh pillow(const Lattice& lattice, double thick, bool inside_out = false) {
  Mesh mesh;
  constexpr uint32_t row = pillow_side + 1, upper = row * row;
  for (const double half : {-0.5, 0.5})
    for (int y = 0; y <= pillow_side; ++y)
      for (int x = 0; x <= pillow_side; ++x)
        mesh.vertices.push_back(lattice.to_world({pillow_edge + x, pillow_edge + y, pillow_middle + half * thick}));
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {  // counter-clockwise seen from outside
    for (Triangle t : {Triangle{a, b, c}, Triangle{a, c, d}}) {
      if (inside_out) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  };
  for (uint32_t y = 0; y < pillow_side; ++y)
    for (uint32_t x = 0; x < pillow_side; ++x) {
      const uint32_t a = y * row + x, b = a + 1, c = b + row, d = a + row;
      add(a, d, c, b);
      add(upper + a, upper + b, upper + c, upper + d);
    }
  const auto wall = [&](uint32_t from, uint32_t to) { add(from, to, upper + to, upper + from); };
  for (uint32_t k = 0; k < pillow_side; ++k) {
    wall(k, k + 1);
    wall(k * row + pillow_side, (k + 1) * row + pillow_side);
    wall(pillow_side * row + k + 1, pillow_side * row + k);
    wall((k + 1) * row, k * row);
  }
  return mesh;
}

/// Four samples per voxel^2 on a level sheet, that look along z.
struct LevelSheet {
  double height = 0;  ///< over the pillow's middle, voxels
  float looks = 1;    ///< 1 up, -1 down
};

using Seen = std::function<bool(double x, double y)>;

inline GridSamples samples_on(const Lattice& lattice, const std::vector<LevelSheet>& sheets, const Seen& seen = {}) {
  PointCloud cloud;
  Random random(3);
  for (const LevelSheet& sheet : sheets)
    for (int i = 0; i < 4 * pillow_side * pillow_side; ++i) {
      const double x = random.uniform(0, pillow_side), y = random.uniform(0, pillow_side);
      if (seen && !seen(x, y)) continue;
      const Vec3d place{pillow_edge + x, pillow_edge + y, pillow_middle + sheet.height + 0.1 * random.normal()};
      cloud.positions.push_back(lattice.to_world(place));
      cloud.normals.push_back({0, 0, sheet.looks});
    }
  return sort_samples(cloud, cloud.normals, lattice, Context(1));
}

}  // namespace soapfilm::test
