#include "soapfilm/adapt/leaf_data.h"

#include <cmath>
#include <functional>
#include <initializer_list>
#include <utility>

#include "soapfilm/adapt/level_samples.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/field/terms.h"
#include "soapfilm/pyramid/restrict.h"

namespace soapfilm {

namespace {

using InBrick = std::function<bool(Vec3i)>;

/// The sum of fields of a level, in some bricks.
SupportField sum_of(std::initializer_list<const SupportField*> fields, const LevelBox& box, const InBrick& in,
                    const Context& context) {
  BrickMask bricks(box.bricks);
  for (const SupportField* field : fields)
    for (size_t b = 0; b < field->grid.size(); ++b)
      if (in(field->grid.coord(b))) bricks.set(field->grid.coord(b));
  SupportField sum;
  sum.grid = BrickGrid(bricks, context);
  sum.f = Field<float>(sum.grid, pages_of(context));
  parallel_for(context, sum.grid.size(), 64, [&](size_t b) {
    float* f = sum.f.brick(b);
    for (const SupportField* field : fields) {
      const int32_t n = field->grid.find(sum.grid.coord(b));
      for (int i = 0; n >= 0 && i < brick_volume; ++i) f[i] += field->f.brick(static_cast<size_t>(n))[i];
    }
  });
  return sum;
}

/// Each fine vertex has an eighth of its coarse one's.
SupportField on_children(const SupportField& coarse, const LevelBox& fine, const Context& context) {
  BrickMask bricks(fine.bricks);
  for (size_t b = 0; b < coarse.grid.size(); ++b)
    for (int k = 0; k < 8; ++k) bricks.set(child_of(coarse.grid.coord(b), k));
  SupportField children;
  children.grid = BrickGrid(bricks, context);
  children.f = Field<float>(children.grid, pages_of(context));
  parallel_for(context, children.grid.size(), 64, [&](size_t b) {
    const Vec3i at = children.grid.coord(b), base = octant_base(octant_in_parent(at));
    const float* from = coarse.f.brick(static_cast<size_t>(coarse.grid.find(parent_of(at))));
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = base + vertex_in_brick(i) / 2;
      children.f.brick(b)[i] = 0.125f * from[brick_offset(v.x, v.y, v.z)];
    }
  });
  return children;
}

/// f of the samples, which are on a level, whose places have that level.
SupportField own_data(const LevelSamples& samples, int level, const Regions& regions, const LevelBox& box,
                      const Context& context) {
  const double size = std::ldexp(1.0, level);
  const LevelSamples own = select(
      samples,
      [&](size_t b, uint32_t s) {
        const Vec3d at = Vec3d(samples.samples.bricks.first_vertex(b)) + Vec3d(samples.samples.local[s]);
        return regions.level_at((at + Vec3d{0.5, 0.5, 0.5}) * size - Vec3d{0.5, 0.5, 0.5}) == level;
      },
      context);
  return own.samples.size() > 0 ? data_field(own.samples, box, context) : SupportField{};
}

/// The same of all levels.
std::vector<SupportField> own_data(const GridSamples& samples, const Regions& regions, const Lattice& lattice,
                                   const Context& context) {
  std::vector<SupportField> own(static_cast<size_t>(regions.coarsest()) + 1);
  const auto add = [&](const LevelSamples& of_level, int level) {
    own[static_cast<size_t>(level)] = own_data(of_level, level, regions, lattice.box(level), context);
  };
  const LevelSamples placed{samples, {}, {}};
  add(placed, lattice.added);
  LevelSamples level;
  for (int l = lattice.added + 1; l <= regions.coarsest(); ++l) {
    level = on_next_level(l == lattice.added + 1 ? placed : level, lattice.box(l).bricks, context);
    add(level, l);
  }
  for (int l = lattice.added - 1; l >= 0; --l) {
    level = on_finer_level(l + 1 == lattice.added ? placed : level, with_neighbors(regions.finer(l + 1)),
                           lattice.box(l).bricks, context);
    add(level, l);
  }
  return own;
}

}  // namespace

std::vector<SupportField> data_of_leaves(const GridSamples& samples, const Regions& regions, const Lattice& lattice,
                                         const Context& context) {
  std::vector<SupportField> own = own_data(samples, regions, lattice, context);
  const size_t levels = own.size();
  // What reaches coarser leaves, the finest first; and finer ones, the coarsest first.
  std::vector<SupportField> up(levels), down(levels);
  for (size_t l = 0; l + 1 < levels; ++l) {
    const int level = static_cast<int>(l);
    const SupportField beyond = sum_of(
        {&own[l], &up[l]}, lattice.box(level),
        [&](Vec3i b) { return !regions.has(level, b) && !regions.is_finer(level, b); }, context);
    up[l + 1] = restrict_field(beyond, lattice.box(level + 1), context);
  }
  for (size_t l = levels; l-- > 1;) {
    const int level = static_cast<int>(l);
    const SupportField beyond = sum_of(
        {&own[l], &down[l]}, lattice.box(level), [&](Vec3i b) { return regions.is_finer(level, b); }, context);
    down[l - 1] = on_children(beyond, lattice.box(level - 1), context);
  }
  std::vector<SupportField> data(levels);
  for (size_t l = 0; l < levels; ++l) {
    const int level = static_cast<int>(l);
    data[l] = sum_of(
        {&own[l], &up[l], &down[l]}, lattice.box(level), [&](Vec3i b) { return regions.has(level, b); }, context);
    if (l == 0) continue;
    const SupportField finer = restrict_field(data[l - 1], lattice.box(level), context);
    data[l] = sum_of(
        {&data[l], &finer}, lattice.box(level), [](Vec3i) { return true; }, context);
  }
  return data;
}

}  // namespace soapfilm
