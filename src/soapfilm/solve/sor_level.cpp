// The dual implied by equation (8), for the energy evaluation.
#include <algorithm>
#include <cmath>

#include "soapfilm/core/parallel.h"
#include "soapfilm/solve/dense_level.h"
#include "soapfilm/solve/sor.h"

namespace soapfilm {

namespace {

/// Values at the vertices [first, first + side)^3 of a brick and around it, local coordinates.
template <int first, int side>
struct Cube {
  float values[side * side * side];
  float& at(int x, int y, int z) { return values[(x - first) + side * ((y - first) + side * (z - first))]; }
  float at(int x, int y, int z) const { return const_cast<Cube*>(this)->at(x, y, z); }
};
using Values = Cube<-1, brick_side + 3>;
using Diffusivity = Cube<0, brick_side + 1>;

Values values_around(const DenseField<float>& u, Vec3i first_vertex) {
  Values cube;
  for (int z = -1; z <= brick_side + 1; ++z)
    for (int y = -1; y <= brick_side + 1; ++y)
      for (int x = -1; x <= brick_side + 1; ++x) cube.at(x, y, z) = u.get(first_vertex + Vec3i{x, y, z});
  return cube;
}

Diffusivity diffusivity_of(const Values& u, const SorParams& params) {
  const int lower = params.gradient == SorGradient::central ? 1 : 0;
  const float per_step = 1.0f / static_cast<float>(1 + lower), epsilon = static_cast<float>(params.epsilon);
  Diffusivity g;
  for (int z = 0; z <= brick_side; ++z)
    for (int y = 0; y <= brick_side; ++y)
      for (int x = 0; x <= brick_side; ++x) {
        const float dx = per_step * (u.at(x + 1, y, z) - u.at(x - lower, y, z));
        const float dy = per_step * (u.at(x, y + 1, z) - u.at(x, y - lower, z));
        const float dz = per_step * (u.at(x, y, z + 1) - u.at(x, y, z - lower));
        g.at(x, y, z) = 1.0f / std::sqrt(dx * dx + dy * dy + dz * dz + epsilon * epsilon);
      }
  return g;
}

/// grad^T p = -lambda sum_j g_ij (u_j - u_i): at a fixed point of (8) it equals f, and the dual energy's term is 0.
void imply_dual(const Values& u, const Diffusivity& g, float lambda, float* px, float* py, float* pz) {
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y)
      for (int x = 0; x < brick_side; ++x) {
        const float here = u.at(x, y, z), own = g.at(x, y, z);
        float flux[3] = {0.5f * (own + g.at(x + 1, y, z)) * (u.at(x + 1, y, z) - here),
                         0.5f * (own + g.at(x, y + 1, z)) * (u.at(x, y + 1, z) - here),
                         0.5f * (own + g.at(x, y, z + 1)) * (u.at(x, y, z + 1) - here)};
        const float length = std::sqrt(flux[0] * flux[0] + flux[1] * flux[1] + flux[2] * flux[2]);
        const float scale = lambda / std::max(1.0f, length);
        const int i = brick_offset(x, y, z);
        px[i] = scale * flux[0];
        py[i] = scale * flux[1];
        pz[i] = scale * flux[2];
      }
}

}  // namespace

Level sor_level(const DenseField<float>& u, const LevelBox& box, double lambda, const SupportField& support,
                const SorParams& params, const Context& context) {
  Level level = level_of(u, box, static_cast<float>(lambda), support.grid, support.f, context);
  parallel_for(context, level.grid.size(), 16, [&](size_t b) {
    const Values values = values_around(u, level.grid.first_vertex(b));
    const Diffusivity g = diffusivity_of(values, params);
    imply_dual(values, g, level.lambda, level.p.brick(b, 0), level.p.brick(b, 1), level.p.brick(b, 2));
  });
  return level;
}

}  // namespace soapfilm
