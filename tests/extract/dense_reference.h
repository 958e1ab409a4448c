// Marching cubes on a small dense array, written as plainly as possible: the oracle of the extraction tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "soapfilm/extract/marching_cubes_table.h"
#include "soapfilm/mesh.h"

namespace soapfilm::test {

/// Values at the vertices of a box, x fastest; outside the box the value is `outside`.
struct DenseField {
  Vec3i size;
  std::vector<float> values;
  float outside = 0;

  DenseField(Vec3i s, float fill) : size(s), values(static_cast<size_t>(s.x) * s.y * s.z, fill), outside(fill) {}

  bool contains(Vec3i v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size.x && v.y < size.y && v.z < size.z;
  }
  float& at(Vec3i v) { return values[(static_cast<size_t>(v.z) * size.y + v.y) * size.x + v.x]; }
  float at(Vec3i v) const {
    return contains(v) ? values[(static_cast<size_t>(v.z) * size.y + v.y) * size.x + v.x] : outside;
  }
  void for_each(const std::function<void(Vec3i)>& visit, int margin = 0) const {
    for (int z = -margin; z < size.z + margin; ++z) {
      for (int y = -margin; y < size.y + margin; ++y) {
        for (int x = -margin; x < size.x + margin; ++x) visit({x, y, z});
      }
    }
  }
};

inline Vec3i corner_offset(int corner) { return {corner & 1, corner >> 1 & 1, corner >> 2}; }

using IsKnown = std::function<bool(Vec3i)>;

/// A vertex's value over `isovalue`, at least 1/1000 of the largest difference along its cut edges.
inline double height_of(const DenseField& field, float isovalue, Vec3i v, const IsKnown& known) {
  const double height = double{field.at(v)} - isovalue;
  double steepest = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const int up : {-1, 1}) {
      Vec3i n = v;
      n[axis] += up;
      const double other = double{field.at(n)} - isovalue;
      if (known(n) && (other > 0) != (height > 0)) steepest = std::max(steepest, std::abs(other - height));
    }
  return height > 0 ? std::max(height, 1e-3 * steepest) : std::min(height, -1e-3 * steepest);
}

/// Of the edge from a to b; an edge cut 0.15 or more from both ends keeps its values.
inline double cut_fraction(const DenseField& field, float isovalue, Vec3i a, Vec3i b, const IsKnown& known) {
  double low = double{field.at(a)} - isovalue, high = double{field.at(b)} - isovalue;
  const double cut = low / (low - high);
  if (cut < 0.15 || cut > 0.85) {
    low = height_of(field, isovalue, a, known);
    high = height_of(field, isovalue, b, known);
  }
  return std::clamp(low / (low - high), 1e-3, 1 - 1e-3);
}

/// Of the cells whose corners are all `known`.
inline Mesh dense_isosurface(
    const DenseField& field, float isovalue, const IsKnown& known = [](Vec3i) { return true; }) {
  using namespace marching_cubes;
  Mesh mesh;
  std::map<std::array<int, 4>, uint32_t> vertex_of_edge;
  field.for_each(
      [&](Vec3i cell) {
        int inside = 0;
        for (int c = 0; c < corner_count; ++c) {
          const Vec3i corner = cell + corner_offset(c);
          if (!known(corner)) return;
          inside |= (field.at(corner) > isovalue) << c;
        }
        const auto vertex_on = [&](int edge) {
          const Vec3i a = cell + corner_offset(edge_corner(edge));
          Vec3i b = a;
          ++b[edge_axis(edge)];
          const auto [it, is_new] =
              vertex_of_edge.try_emplace({a.x, a.y, a.z, edge_axis(edge)}, static_cast<uint32_t>(mesh.vertices.size()));
          if (is_new) {
            Vec3d p(a);
            p[edge_axis(edge)] += cut_fraction(field, isovalue, a, b, known);
            mesh.vertices.push_back(p);
          }
          return it->second;
        };
        const Case& c = cases()[inside];
        for (int i = 0; i < c.triangle_count; ++i) {
          const auto& t = c.triangles[i];
          mesh.triangles.push_back({vertex_on(t[0]), vertex_on(t[1]), vertex_on(t[2])});
        }
      },
      1);
  return mesh;
}

/// V - E + F - C of the inside's vertices, unit edges, unit squares and unit cubes.
inline int64_t euler_characteristic_of_inside(const DenseField& field, float isovalue) {
  int64_t sum = 0;
  field.for_each(
      [&](Vec3i v) {
        for (int extent = 0; extent < 8; ++extent) {  // the axes along which the face extends
          bool whole = true;
          for (int c = 0; c < 8; ++c) {
            if ((c & ~extent) == 0) whole = whole && field.at(v + corner_offset(c)) > isovalue;
          }
          const int dimension = (extent & 1) + (extent >> 1 & 1) + (extent >> 2);
          if (whole) sum += dimension % 2 == 0 ? 1 : -1;
        }
      },
      1);
  return sum;
}

}  // namespace soapfilm::test
