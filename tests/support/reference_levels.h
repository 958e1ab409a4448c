// The data term, its restriction and the prolongation of a level as loops over all vertices of the box, in float, in
// the order that their headers write.
#pragma once

#include <array>

#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/smoothing.h"
#include "soapfilm/grid/trilinear.h"
#include "soapfilm/solve/level.h"
#include "support/dense.h"

namespace soapfilm::test {

/// visit(vertex, brick, position in it) for all vertices of a grid.
template <class Visit>
void for_each_grid_vertex(const BrickGrid& grid, Visit&& visit) {
  for (size_t b = 0; b < grid.size(); ++b) for_each_vertex(grid.coord(b), [&](Vec3i v, int i) { visit(v, b, i); });
}

/// What the samples of each brick give to its vertices and to those one beyond, added in lattice order.
inline std::array<Dense<float>, 3> splatted(const GridSamples& samples, Vec3i bricks) {
  const Dense<float> zero(bricks * brick_side);
  std::array<Dense<float>, 3> all{zero, zero, zero};
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    const Dense<float> none({brick_side + 1, brick_side + 1, brick_side + 1});
    std::array<Dense<float>, 3> own{none, none, none};
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Vec3f q = samples.local[s];
      const Vec3i cell = cell_in_brick(q);
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3i c{corner & 1, corner >> 1 & 1, corner >> 2};
        const auto share = [&](int axis) {
          const float t = q[axis] - static_cast<float>(cell[axis]);
          return c[axis] == 1 ? t : 1 - t;
        };
        const float weight = share(0) * share(1) * share(2);
        for (size_t k = 0; k < 3; ++k) own[k][cell + c] += weight * samples.direction[s][static_cast<int>(k)];
      }
    }
    none.for_each([&](Vec3i v) {
      const Vec3i at = samples.bricks.first_vertex(b) + v;
      for (size_t k = 0; k < 3; ++k)
        if (zero.contains(at)) all[k][at] += own[k][v];
    });
  }
  return all;
}

/// Taps of -4 to 4 along one axis, the first one first.
inline Dense<float> filtered(const Dense<float>& in, int axis, const std::array<float, 9>& taps) {
  Dense<float> out(in.size());
  out.for_each([&](Vec3i v) {
    float sum = 0;
    for (int j = 0; j < 9; ++j) {
      Vec3i at = v;
      at[axis] += j - 4;
      sum += taps[static_cast<size_t>(j)] * in.get(at);
    }
    out[v] = sum;
  });
  return out;
}

inline void reference_divergence(const GridSamples& samples, SupportField& field) {
  std::array<float, 9> smooth{}, difference{};
  constexpr int k[] = {0, 0, 1, 3, 6, 7, 6, 3, 1, 0, 0};
  for (size_t j = 0; j < 9; ++j) difference[j] = static_cast<float>(k[j] - k[j + 2]) / 54.0f;
  for (size_t j = 0; j < smoothing_taps.size(); ++j) smooth[j + 1] = smoothing_taps[j];
  const auto v = splatted(samples, field.grid.bricks());
  const auto passes = [&](size_t component, int axis) {
    return filtered(v[component], axis, component == static_cast<size_t>(axis) ? difference : smooth);
  };
  const Dense<float> x = filtered(passes(0, 0), 1, smooth), y = filtered(passes(1, 0), 1, difference),
                     z = filtered(passes(2, 0), 1, smooth);
  Dense<float> both(x.size());
  both.for_each([&](Vec3i at) { both[at] = x[at] + y[at]; });
  const Dense<float> flat = filtered(both, 2, smooth), up = filtered(z, 2, difference);
  for_each_grid_vertex(field.grid, [&](Vec3i at, size_t b, int i) { field.f.brick(b)[i] = flat[at] + up[at]; });
}

inline void reference_restriction(const SupportField& fine, SupportField& coarse) {
  Dense<float> f(coarse.grid.bricks() * (2 * brick_side));
  for_each_grid_vertex(fine.grid, [&](Vec3i v, size_t b, int i) { f[v] = fine.f.brick(b)[i]; });
  for_each_grid_vertex(coarse.grid, [&](Vec3i v, size_t b, int i) {
    float sum = 0;
    for (int child = 0; child < 8; ++child) sum += f[2 * v + Vec3i{child & 1, child >> 1 & 1, child >> 2}];
    coarse.f.brick(b)[i] = sum;
  });
}

/// As pyramid/prolong.h has it.
class ReferenceProlongation {
 public:
  explicit ReferenceProlongation(const Level& coarse) : coarse_(coarse), p_(dense_p(coarse)) {}

  void onto(Level& fine, const Level* previous) const {
    for_each_grid_vertex(fine.grid, [&](Vec3i v, size_t b, int i) {
      const int32_t old = previous ? previous->grid.find(fine.grid.coord(b)) : -1;
      const auto kept = static_cast<size_t>(old);
      fine.u.brick(b)[i] = old >= 0 ? previous->u.brick(kept)[i] : fine.box.is_free(v) ? u(v) : 0.0f;
      for (int axis = 0; axis < 3; ++axis)
        fine.p.brick(b, axis)[i] = old >= 0 ? previous->p.brick(kept, axis)[i] : flux(v, axis);
    });
    for (size_t b = 0; b < fine.grid.size(); ++b)
      for (int axis = 0; axis < 3; ++axis) {
        float* plane = fine.rim.plane(b, axis);
        for (int k = 0; plane && k < brick_area; ++k) {
          Vec3i v = fine.grid.first_vertex(b) - along(axis);
          v[axis == 0 ? 1 : 0] += k % brick_side;
          v[axis == 2 ? 1 : 2] += k / brick_side;
          plane[k] = flux(v, axis);
        }
      }
  }

 private:
  static Vec3i parent(Vec3i v) { return {v.x >> 1, v.y >> 1, v.z >> 1}; }
  static float blend(float near, float far) { return 0.75f * near + 0.25f * far; }

  float coarse_u(Vec3i around, Vec3i v) const {
    const bool goes_on = coarse_.box.open && has_free(coarse_.box, brick_of(around));
    return coarse_.u_at(goes_on ? nearest_free(coarse_.box, v) : v);
  }
  float u(Vec3i v) const {
    const Vec3i near = parent(v);
    Vec3i far = near;
    for (int axis = 0; axis < 3; ++axis) far[axis] += (v[axis] & 1) == 1 ? 1 : -1;
    const auto along_x = [&](int y, int z) {
      return blend(coarse_u(near, {near.x, y, z}), coarse_u(near, {far.x, y, z}));
    };
    const auto along_y = [&](int z) { return blend(along_x(near.y, z), along_x(far.y, z)); };
    return blend(along_y(near.z), along_y(far.z));
  }
  /// Through the face above fine vertex v.
  float flux(Vec3i v, int axis) const {
    const auto of = [&](Vec3i c) { return static_cast<float>(p_[static_cast<size_t>(axis)].get(c)); };
    const float above = of(parent(v));
    return (v[axis] & 1) == 1 ? 0.25f * above : 0.25f * (0.5f * (of(parent(v) - along(axis)) + above));
  }

  const Level& coarse_;
  DenseVectors p_;
};

}  // namespace soapfilm::test
