#include "soapfilm/solve/dense_level.h"

#include <algorithm>
#include <vector>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// u = 0 beyond the box.
BrickContent content_of(const DenseField<float>& u, Vec3i brick) {
  bool zero = false, one = false, other = false;
  int covered = 0;
  for_each_run(u, brick, [&](const float* row, int, int, int, int n) {
    covered += n;
    for (int i = 0; i < n; ++i) (row[i] == 0.0f ? zero : row[i] == 1.0f ? one : other) = true;
  });
  if (covered < brick_volume) zero = true;
  if (other || zero == one) return BrickContent::mixed;
  return one ? BrickContent::one : BrickContent::zero;
}

/// Per brick of the box.
std::vector<BrickContent> classify(const DenseField<float>& u, Vec3i bricks, const Context& context) {
  const size_t row = static_cast<size_t>(bricks.x),
               rows = static_cast<size_t>(bricks.y) * static_cast<size_t>(bricks.z);
  std::vector<BrickContent> content(row * rows);
  parallel_for(context, rows, 1, [&](size_t r) {
    const int y = static_cast<int>(r % static_cast<size_t>(bricks.y)),
              z = static_cast<int>(r / static_cast<size_t>(bricks.y));
    for (int x = 0; x < bricks.x; ++x) content[r * row + static_cast<size_t>(x)] = content_of(u, {x, y, z});
  });
  return content;
}

}  // namespace

BrickMask interface_bricks(const std::vector<BrickContent>& content, Vec3i bricks) {
  BrickMask mask(bricks);
  const auto at = [&](Vec3i b) {
    return mask.contains(b) ? content[static_cast<size_t>((b.z * bricks.y + b.y)) * static_cast<size_t>(bricks.x) +
                                      static_cast<size_t>(b.x)]
                            : BrickContent::zero;
  };
  for (int z = 0; z < bricks.z; ++z) {
    for (int y = 0; y < bricks.y; ++y) {
      for (int x = 0; x < bricks.x; ++x) {
        const Vec3i b{x, y, z};
        bool interface = at(b) == BrickContent::mixed;
        for (int slot = 0; slot < 27 && !interface; ++slot) interface = at(b + slot_offset(slot)) != at(b);
        if (interface) mask.set(b);
      }
    }
  }
  return mask;
}

BrickMask interface_bricks(const DenseField<float>& u, const LevelBox& box, const Context& context) {
  return interface_bricks(classify(u, box.bricks, context), box.bricks);
}

Level level_of(const DenseField<float>& u, const LevelBox& box, float lambda, const BrickGrid& support,
               const Field<float>& f, const Context& context, Norm norm) {
  BrickMask band = interface_bricks(u, box, context);
  add_bricks(support, band);
  Level level = make_level(box, lambda, band, support, f, context, norm);
  parallel_for(context, level.grid.size(), 64, [&](size_t b) {
    for_each_run(u, level.grid.coord(b), [&](const float* row, int x, int y, int z, int n) {
      std::copy(row, row + n, level.u.brick(b) + brick_offset(x, y, z));
    });
  });
  level.inside = GapSides(level.grid, bricks_with_free(box), [&](Vec3i b) { return u.get(b * brick_side) == 1.0f; });
  return level;
}

}  // namespace soapfilm
