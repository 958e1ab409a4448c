#include "soapfilm/surface/dense_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/solve/dense_level.h"

namespace soapfilm {

double mean_at_samples(const DenseField<float>& u, const GridSamples& samples, const Context& context) {
  std::vector<double> sums(samples.bricks.size());
  parallel_for(context, sums.size(), 16, [&](size_t b) {
    const Vec3i first = samples.bricks.first_vertex(b);
    double sum = 0;
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Vec3f q = samples.local[s];
      const Vec3i cell{static_cast<int>(q.x), static_cast<int>(q.y), static_cast<int>(q.z)};
      const Vec3d f = Vec3d(q) - Vec3d(cell);
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3i c{corner & 1, (corner >> 1) & 1, corner >> 2};
        sum += (c.x ? f.x : 1 - f.x) * (c.y ? f.y : 1 - f.y) * (c.z ? f.z : 1 - f.z) * u.get(first + cell + c);
      }
    }
    sums[b] = sum;
  });
  return ordered_sum(samples.bricks, sums) / static_cast<double>(samples.size());
}

DenseSurface dense_surface(const DenseField<float>& u, double isovalue, const LevelBox& box, const Context& context) {
  if (!(isovalue > 0))
    throw ParameterError(fmt::format("isovalue = {:.4g}, must be > 0, the value of u outside the box", isovalue));
  const auto scale = static_cast<float>(0.5 / isovalue);
  DenseSurface surface;
  surface.binary = DenseField<float>(box, pages_of(context));
  parallel_chunks(context, u.count(), size_t{1} << 16, [&](size_t begin, size_t end) {
    const float* in = u.data();
    float* out = surface.binary.data();
    for (size_t i = begin; i < end; ++i) out[i] = scale * in[i] > 0.5f ? 1.0f : 0.0f;
  });

  IndicatorField& field = surface.field;
  const BrickMask bricks = interface_bricks(surface.binary, box, context);
  field.grid = BrickGrid(bricks, context);
  field.value = Field<float>(field.grid, pages_of(context));
  parallel_for(context, field.grid.size(), 64, [&](size_t b) {
    for_each_run(u, field.grid.coord(b), [&](const float* row, int x, int y, int z, int n) {
      std::transform(row, row + n, field.value.brick(b) + brick_offset(x, y, z), [&](float v) { return scale * v; });
    });
  });
  field.inside = GapSides(field.grid, bricks_with_free(box),
                          [&](Vec3i brick) { return surface.binary.get(brick * brick_side) > 0.5f; });
  return surface;
}

}  // namespace soapfilm
