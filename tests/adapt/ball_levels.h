// Distances from a ball on several levels, and regions that are finer on one side.
#pragma once

#include <functional>
#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/grid/leaves.h"
#include "soapfilm/surface/surface_field.h"
#include "support/dense.h"

namespace soapfilm::test {

/// 16^3 bricks of the finest level.
inline Lattice small_lattice() {
  Lattice lattice;
  lattice.voxel = 1;
  lattice.levels = 4;
  lattice.size = {112, 112, 112};
  lattice.first_vertex = Vec3d(lattice.margin());
  return lattice;
}

/// A level's field of a function of the place, in voxels of the finest level, on all bricks of its box.
inline DistanceField field_of(const Lattice& lattice, int level, const std::function<double(Vec3d)>& distance) {
  const Context context(1);
  DistanceField field;
  field.grid = BrickGrid(BrickMask::whole(lattice.box(level).bricks), context);
  field.value = Field<float>(field.grid);
  field.inside = GapSides(field.grid);
  for (size_t b = 0; b < field.grid.size(); ++b)
    for_each_vertex(field.grid.coord(b), [&](Vec3i v, int i) {
      field.value.brick(b)[i] = static_cast<float>(std::ldexp(distance(leaf_center(level, v)), -level));
    });
  return field;
}

/// Level 0 where x is below a plane, level 1 beyond it; of the finer ones those with x below `asked` must be.
inline Regions halves(const Lattice& lattice, int until, int asked) {
  BrickMask finer(lattice.box(1).bricks), must(lattice.box(1).bricks);
  BrickRange::whole(finer.bricks()).for_each([&](Vec3i b) {
    if (b.x < until) finer.set(b);
    if (b.x < asked) must.set(b);
  });
  return {{finer}, {must}};
}

}  // namespace soapfilm::test
