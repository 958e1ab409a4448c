#include "soapfilm/solve/level.h"

#include <algorithm>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

alignas(64) constexpr float zeros[brick_volume] = {};

}  // namespace

Rim::Rim(const BrickGrid& grid, const PagePool& pages) : plane_(grid.size()) {
  int32_t planes = 0;
  for (size_t b = 0; b < grid.size(); ++b)
    for (size_t axis = 0; axis < 3; ++axis)
      plane_[b][axis] = grid.neighbors(b)[slot_down[axis]] == outside_band ? planes++ : no_plane;
  flux_ = AlignedArray<float>(static_cast<size_t>(planes) * brick_area, pages);
}

size_t Rim::planes_before(size_t brick) const {
  for (; brick < plane_.size(); ++brick)
    for (const int32_t plane : plane_[brick])
      if (plane != no_plane) return static_cast<size_t>(plane);
  return flux_.size() / brick_area;
}

const float* LevelProblem::data(size_t brick) const {
  const int32_t k = f_brick[brick];
  return k < 0 ? zeros : f->brick(static_cast<size_t>(k));
}

Level make_level(const LevelBox& box, float lambda, const BrickMask& band, const BrickGrid& support,
                 const Field<float>& f, const Context& context, Norm norm) {
  Level level;
  level.box = box;
  level.lambda = lambda;
  level.norm = norm;
  level.grid = BrickGrid(band, context);
  level.inside = GapSides(level.grid);
  level.u = Field<float>(level.grid, pages_of(context));
  level.p = Field<float, 3>(level.grid, pages_of(context));
  level.rim = Rim(level.grid, pages_of(context));
  level.f = &f;
  level.f_brick.resize(level.grid.size());
  parallel_for(context, level.grid.size(), 1024,
               [&](size_t b) { level.f_brick[b] = std::max(-1, support.find(level.grid.coord(b))); });
  return level;
}

void scale_flux(Level& level, float share, const Context& context) {
  const ItemRange bricks = bricks_at_hand(level);
  parallel_for(context, bricks.size(), 64, [&](size_t b) {
    for (int axis = 0; axis < 3; ++axis) {
      float* p = level.p.brick(bricks.begin + b, axis);
      for (int i = 0; i < brick_volume; ++i) p[i] *= share;
    }
  });
  const ItemRange planes = level.rim.planes(bricks);
  float* rim = level.rim.flux().data();
  for (size_t i = planes.begin * brick_area; i < planes.end * brick_area; ++i) rim[i] *= share;
  OutsideTerms& outside = level.outside;
  outside = {outside.data, outside.gain, outside.dual_of_scaled(share), outside.gap_of_scaled(share)};
}

ItemRange bricks_at_hand(const Level& level) {
  return level.slabs ? bricks_of(level.grid, level.slabs->own().widened(1, 1)) : ItemRange{0, level.grid.size()};
}

LowFace low_face(const Level& level, size_t brick, int axis) {
  // Along x the two remaining axes are (y, z), along y (x, z), along z (x, y).
  const int32_t neighbor = level.grid.neighbors(brick)[slot_down[axis]];
  if (neighbor >= 0) {
    const float* last_layer = level.p.brick(static_cast<size_t>(neighbor), axis) + 7 * brick_stride[axis];
    const auto [inner, outer] = strides_across(axis);
    return {last_layer, inner, outer};
  }
  const float* plane = level.rim.plane(brick, axis);
  return {plane ? plane : zeros, 1, brick_side};
}

}  // namespace soapfilm
