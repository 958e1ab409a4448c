// Memory layout of a brick, the unit of every array on the grid:
//
//   a brick is 8 x 8 x 8 vertices; vertex (x, y, z) of brick (bx, by, bz) is lattice vertex (8 bx + x, 8 by + y, 8 bz +
//   z) and sits at position x + 8 y + 64 z of the brick's 512 values. A row (fixed y, z) is 32 bytes: one AVX register.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "soapfilm/core/vec.h"

namespace soapfilm {

inline constexpr int brick_side = 8;
inline constexpr int brick_area = brick_side * brick_side;
inline constexpr int brick_volume = brick_side * brick_side * brick_side;

/// Distance in a brick's values between neighbors along x, y, z.
inline constexpr int brick_stride[3] = {1, brick_side, brick_area};
/// The same along the two axes other than `axis`, the lower one first.
constexpr std::array<int, 2> strides_across(int axis) {
  return {brick_stride[axis == 0 ? 1 : 0], brick_stride[axis == 2 ? 1 : 2]};
}

constexpr int brick_offset(int x, int y, int z) { return x + brick_side * y + brick_area * z; }
/// Its inverse: the vertex in its brick, each coordinate in [0, 8).
constexpr Vec3i vertex_in_brick(int i) { return {i & 7, i >> 3 & 7, i >> 6}; }

/// The brick that holds a lattice vertex; valid for negative coordinates too.
constexpr Vec3i brick_of(Vec3i vertex) { return {vertex.x >> 3, vertex.y >> 3, vertex.z >> 3}; }
/// The brick whose cube, from its first vertex to that of the next brick, holds a place in lattice coordinates.
inline Vec3i brick_around(Vec3d place) {
  const auto index = [](double x) { return static_cast<int32_t>(std::floor(x / brick_side)); };
  return {index(place.x), index(place.y), index(place.z)};
}

/// The cell of a brick, by its first vertex, that holds a place relative to the brick's; one that was rounded up to the
/// next brick is in the last.
constexpr Vec3i cell_in_brick(Vec3f local) {
  const auto index = [](float x) { return std::min(static_cast<int32_t>(x), brick_side - 1); };
  return {index(local.x), index(local.y), index(local.z)};
}

/// Area of a level's face, in faces of the finest level: 4^level.
constexpr double face_area(int level) { return static_cast<double>(uint64_t{1} << (2 * level)); }

/// A tile has 2^5 = 32 bricks, 256 vertices, along each axis.
inline constexpr int tile_bits = 5;

/// A brick of the next coarser level, the parent, covers eight bricks, its children: one per octant, of twice its
/// resolution. Octants are numbered x fastest.
inline constexpr int half_brick = brick_side / 2;
inline constexpr int octant_volume = half_brick * half_brick * half_brick;
constexpr int octant_offset(int x, int y, int z) { return x + half_brick * (y + half_brick * z); }
constexpr Vec3i octant_of(int k) { return {k & 1, k >> 1 & 1, k >> 2}; }
constexpr Vec3i child_of(Vec3i parent, Vec3i octant) { return parent * 2 + octant; }
constexpr Vec3i child_of(Vec3i parent, int k) { return child_of(parent, octant_of(k)); }
constexpr Vec3i parent_of(Vec3i child) { return {child.x >> 1, child.y >> 1, child.z >> 1}; }
/// Which octant of its parent a brick covers.
constexpr Vec3i octant_in_parent(Vec3i child) { return {child.x & 1, child.y & 1, child.z & 1}; }
/// First vertex of an octant in its brick, coarse vertices.
constexpr Vec3i octant_base(Vec3i octant) { return octant * half_brick; }

/// Position among a brick's 27 neighbors (itself in the middle) of the one at (dx, dy, dz), each in -1..1.
constexpr int neighbor_slot(int dx, int dy, int dz) { return (dx + 1) + 3 * (dy + 1) + 9 * (dz + 1); }
/// Its inverse.
constexpr Vec3i slot_offset(int slot) { return {slot % 3 - 1, slot / 3 % 3 - 1, slot / 9 - 1}; }
inline constexpr int own_slot = neighbor_slot(0, 0, 0);
/// Slots of the neighbors one brick down and one brick up along x, y, z.
inline constexpr int slot_down[3] = {neighbor_slot(-1, 0, 0), neighbor_slot(0, -1, 0), neighbor_slot(0, 0, -1)};
inline constexpr int slot_up[3] = {neighbor_slot(1, 0, 0), neighbor_slot(0, 1, 0), neighbor_slot(0, 0, 1)};

/// Slot values for "no such brick".
inline constexpr int outside_band = -1;  ///< inside the domain, but not active
inline constexpr int outside_box = -2;   ///< beyond the domain, where u = 0

}  // namespace soapfilm
