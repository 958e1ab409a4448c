#include "soapfilm/adapt/agreement.h"

#include <algorithm>
#include <cstdint>

#include "soapfilm/adapt/surroundings.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr int few = 16;  // vertices of a brick: a surface that differs by a voxel in a corner of it

/// Vertices of a coarse brick on one side of the coarse surface all of whose eight children are on the other.
int disagreeing(const Labels& coarse, const Labels& fine, Vec3i brick) {
  const BrickBits& own = coarse.of(brick);
  int count = 0;
  for_each_with_children(fine, brick,
                         [&](Vec3i v, int inside) { count += inside == (own.test(v.x, v.y, v.z) ? 0 : 8); });
  return count;
}

/// Of one level: the bricks from its border on in which it disagrees with the next finer one, connected;
/// of those that are not asked for.
std::vector<Vec3i> from_border(const Regions& regions, int level, const Labels& coarse, const Labels& fine,
                               const Context& context) {
  std::vector<Vec3i> bricks;
  regions.finer(level).for_each([&](Vec3i b) {
    if (!regions.asked(level).test(b)) bricks.push_back(b);
  });
  std::vector<uint8_t> differs(bricks.size());
  parallel_for(context, bricks.size(), 64, [&](size_t b) { differs[b] = disagreeing(coarse, fine, bricks[b]) > few; });
  BrickMask open(regions.finer(level).bricks());  // not found yet
  for (size_t b = 0; b < bricks.size(); ++b)
    if (differs[b] != 0) open.set(bricks[b]);
  std::vector<Vec3i> found;
  const auto take = [&](Vec3i b) {
    open.set(b, false);
    found.push_back(b);
  };
  for (size_t b = 0; b < bricks.size(); ++b) {
    if (differs[b] == 0) continue;
    bool at_border = false;
    for (int slot = 0; slot < 27; ++slot)
      at_border = at_border || !regions.is_finer(level, bricks[b] + slot_offset(slot));
    if (at_border) take(bricks[b]);
  }
  for (size_t k = 0; k < found.size(); ++k)
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i n = found[k] + slot_offset(slot); open.contains(n) && open.test(n)) take(n);
  return found;
}

}  // namespace

void give_back_disagreement(Regions& regions, int level, const Labels& coarse, const Labels& fine,
                            const Context& context) {
  regions.give_back(level, from_border(regions, level, coarse, fine, context));
}

}  // namespace soapfilm
