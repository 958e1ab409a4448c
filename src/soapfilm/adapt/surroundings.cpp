#include "soapfilm/adapt/surroundings.h"

#include "soapfilm/core/parallel.h"
#include "soapfilm/surface/indicator.h"

namespace soapfilm {

namespace {

/// The labels on these bricks, which hold those of the level; beyond its places as on the coarser one.
Labels on_bricks(const BrickMask& bricks, const Labels& fine, const Labels& coarse, const Context& context) {
  Labels all;
  static_cast<Domain&>(all) = {fine.box, BrickGrid(bricks, context), fine.inside, fine.places};
  all.bits.resize(all.grid.size());
  parallel_for(context, all.grid.size(), 64, [&](size_t b) {
    const Vec3i at = all.grid.coord(b);
    all.bits[b] = fine.covers(at) ? fine.of(at) : bits_of_child(coarse.of(parent_of(at)), at);
  });
  return all;
}

}  // namespace

BrickBits most_of_children(const Labels& fine, Vec3i parent) {
  BrickBits bits;
  for_each_with_children(fine, parent, [&](Vec3i v, int inside) {
    if (inside >= 4) bits.set(brick_offset(v.x, v.y, v.z));
  });
  return bits;
}

BrickBits bits_of_child(const BrickBits& parent, Vec3i brick) {
  const Vec3i base = octant_base(octant_in_parent(brick));
  BrickBits bits;
  for (int i = 0; i < brick_volume; ++i) {
    const Vec3i v = base + vertex_in_brick(i) / 2;
    if (parent.test(v.x, v.y, v.z)) bits.set(i);
  }
  return bits;
}

Labels with_surroundings(const Labels& fine, const Labels& coarse, const Context& context) {
  BrickMask bricks(fine.box.bricks);
  add_bricks(fine.grid, bricks);
  for (size_t b = 0; b < fine.grid.size(); ++b)
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i n = fine.grid.coord(b) + slot_offset(slot); bricks.contains(n) && !fine.covers(n)) bricks.set(n);
  const Labels ringed = on_bricks(bricks, fine, coarse, context);
  bricks |= bricks_near_surface(ringed, context);
  return on_bricks(bricks, ringed, coarse, context);
}

}  // namespace soapfilm
