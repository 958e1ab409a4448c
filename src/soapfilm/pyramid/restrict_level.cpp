#include "soapfilm/pyramid/restrict_level.h"

#include <array>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// u and p of the eight children of a coarse brick.
class Children {
 public:
  Children(const Level& fine, Vec3i parent) : fine_(fine), parent_(parent) {
    for (int k = 0; k < 8; ++k) brick_[static_cast<size_t>(k)] = fine.grid.find(child_of(parent, k));
  }

  /// The mean of u at the free children of coarse vertex `v`; 0 where none is free.
  float u(Vec3i v) const {
    const size_t k = octant_of_vertex(v);
    const Vec3i child = child_of(parent_, static_cast<int>(k)), first = first_child(v);
    const float missing = brick_[k] < 0 ? fine_.missing_u(brick_[k], child) : 0;
    float sum = 0;
    int free = 0;
    for (int c = 0; c < 8; ++c) {
      const Vec3i at = first + octant_of(c);
      if (!fine_.box.is_free(child * brick_side + at)) continue;
      sum += brick_[k] < 0 ? missing : fine_.u.brick(static_cast<size_t>(brick_[k]))[brick_offset(at.x, at.y, at.z)];
      ++free;
    }
    return free > 0 ? sum / static_cast<float>(free) : 0.0f;
  }

  /// The flux through the upper face of coarse vertex `v` along an axis.
  float p(Vec3i v, int axis) const {
    const size_t k = octant_of_vertex(v);
    Vec3i first = first_child(v);
    ++first[axis];
    const Vec3i child = child_of(parent_, static_cast<int>(k));
    return sum_over_face(brick_[k], child, first, axis);
  }

  /// The flux through the lower face of a vertex in the first layer of the coarse brick along an axis.
  float p_below(Vec3i v, int axis) const {
    const size_t k = octant_of_vertex(v);
    return brick_[k] < 0 ? 0.0f : sum_below(static_cast<size_t>(brick_[k]), first_child(v), axis);
  }

 private:
  static size_t octant_of_vertex(Vec3i v) {
    return static_cast<size_t>(v.x / half_brick + 2 * (v.y / half_brick) + 4 * (v.z / half_brick));
  }
  static Vec3i first_child(Vec3i v) { return {2 * v.x % brick_side, 2 * v.y % brick_side, 2 * v.z % brick_side}; }

  /// Of the four faces above the fine vertices from `first` on, in a brick or, where the grid lacks it, below the next.
  float sum_over_face(int32_t brick, Vec3i coord, Vec3i first, int axis) const {
    if (brick < 0) {
      if (first[axis] + 1 < brick_side) return 0;
      const int32_t above = fine_.grid.find(coord + slot_offset(slot_up[axis]));
      first[axis] = 0;
      return above < 0 ? 0.0f : sum_below(static_cast<size_t>(above), first, axis);
    }
    const float* p = fine_.p.brick(static_cast<size_t>(brick), axis);
    float sum = 0;
    for_each_face(first, axis, [&](Vec3i at) { sum += p[brick_offset(at.x, at.y, at.z)]; });
    return sum;
  }

  float sum_below(size_t brick, Vec3i first, int axis) const {
    const LowFace low = low_face(fine_, brick, axis);
    float sum = 0;
    for_each_face(first, axis, [&](Vec3i at) { sum += low.at(at[axis == 0 ? 1 : 0], at[axis == 2 ? 1 : 2]); });
    return sum;
  }

  template <class Visit>
  static void for_each_face(Vec3i first, int axis, Visit&& visit) {
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    for (int k = 0; k < 4; ++k) {
      Vec3i at = first;
      at[a] += k & 1;
      at[b] += k >> 1;
      visit(at);
    }
  }

  const Level& fine_;
  Vec3i parent_;
  std::array<int32_t, 8> brick_;
};

}  // namespace

Level restrict_level(const Level& fine, const LevelBox& box, const BrickMask& bricks, const SupportField& support,
                     const Context& context) {
  Level coarse = make_level(box, 4 * fine.lambda, bricks, support.grid, support.f, context, fine.norm);
  coarse.inside = GapSides(coarse.grid, bricks_with_free(box), [&](Vec3i brick) {
    const Vec3i child = brick_of(nearest_free(fine.box, child_of(brick, 0) * brick_side));
    return fine.inside.test(fine.grid, child);
  });
  parallel_for(context, coarse.grid.size(), 64, [&](size_t b) {
    const Children children(fine, coarse.grid.coord(b));
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = vertex_in_brick(i);
      coarse.u.brick(b)[i] = box.is_free(coarse.grid.first_vertex(b) + v) ? children.u(v) : 0.0f;
      for (int axis = 0; axis < 3; ++axis) coarse.p.brick(b, axis)[i] = children.p(v, axis);
    }
    for (int axis = 0; axis < 3; ++axis) {
      float* plane = coarse.rim.plane(b, axis);
      for (int k = 0; plane && k < brick_area; ++k) {
        Vec3i v;
        v[axis == 0 ? 1 : 0] = k % brick_side;
        v[axis == 2 ? 1 : 2] = k / brick_side;
        plane[k] = children.p_below(v, axis);
      }
    }
  });
  return coarse;
}

}  // namespace soapfilm
