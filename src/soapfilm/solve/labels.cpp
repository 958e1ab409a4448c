#include "soapfilm/solve/labels.h"

#include <algorithm>
#include <utility>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// Vertices of a brick's lowest layer along an axis that are inside.
size_t inside_lowest(const BrickBits& bits, int axis) {
  constexpr uint64_t lowest_x = 0x0101010101010101, lowest_y = 0xff;
  if (axis == 2) return static_cast<size_t>(count_bits(bits.layer[0]));
  size_t count = 0;
  for (const uint64_t layer : bits.layer)
    count += static_cast<size_t>(count_bits(layer & (axis == 0 ? lowest_x : lowest_y)));
  return count;
}

}  // namespace

const BrickBits& LabelView::of(int32_t n, Vec3i brick) const {
  static const BrickBits none, all = BrickBits::full();
  return n >= 0 ? bits_[static_cast<size_t>(n)] : domain_.is_inside(n, brick) ? all : none;
}

BrickBits LabelView::continued(int32_t n, Vec3i brick) const {
  const LevelBox& box = domain_.box;
  if (!box.open || free_range(box, brick).whole()) return of(n, brick);
  // Where a brick has no free vertices along an axis, those next to all of its vertices are in the same layer.
  const Vec3i first = brick * brick_side, last = first + Vec3i{brick_side - 1, brick_side - 1, brick_side - 1};
  Vec3i from = brick;
  for (int axis = 0; axis < 3; ++axis)
    if (last[axis] < box.free_lo[axis] || first[axis] > box.free_hi[axis])
      from[axis] = brick_of(nearest_free(box, first))[axis];
  const BrickBits& bits = from == brick ? of(n, brick) : of(domain_.grid.find(from), from);
  BrickBits found;
  for (int i = 0; i < brick_volume; ++i) {
    const Vec3i v = nearest_free(box, first + vertex_in_brick(i)) - from * brick_side;
    if (bits.test(v.x, v.y, v.z)) found.set(i);
  }
  return found;
}

BrickBits LabelView::interface(size_t b) const {
  const BrickBits& own = bits_[b];
  const bool ends = domain_.places || (domain_.box.open && at_border(domain_.box, domain_.grid.coord(b)));
  BrickBits found;
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      const int slot = step > 0 ? slot_down[axis] : slot_up[axis];  // whose bits move into this brick
      const BrickBits& beside =
          of(domain_.grid.neighbors(b)[static_cast<size_t>(slot)], domain_.grid.coord(b) + slot_offset(slot));
      const BrickBits next = moved(own, axis, step) | carried(beside, axis, step);
      found |= ends ? (own ^ next) & joined_to(b, axis, -step) : own ^ next;
    }
  return found;
}

BrickBits LabelView::joined_to(size_t b, int axis, int step) const {
  const Vec3i beside = domain_.grid.coord(b) + slot_offset(step > 0 ? slot_up[axis] : slot_down[axis]);
  BrickBits joined = BrickBits::full();
  if (!domain_.covers(beside) && domain_.grid.find(beside) < 0)
    joined = moved(moved(joined, axis, step), axis, -step);  // all but the last layer
  if (!domain_.box.open || !at_border(domain_.box, domain_.grid.coord(b))) return joined;
  BrickBits found;
  for (int i = 0; i < brick_volume; ++i) {
    const Vec3i v = domain_.grid.first_vertex(b) + vertex_in_brick(i);
    Vec3i next = v;
    next[axis] += step;
    if (domain_.box.is_free(v) && domain_.box.is_free(next)) found.set(i);
  }
  return found & joined;
}

std::vector<BrickBits> LabelView::interfaces(const Context& context) const {
  std::vector<BrickBits> found(bits_.size());
  parallel_for(context, found.size(), 64, [&](size_t b) { found[b] = interface(b); });
  return found;
}

std::vector<BrickBits> bits_above(const Level& level, float threshold, const Context& context) {
  std::vector<BrickBits> bits(level.grid.size());
  for_each_brick(bits, level.grid, level.slabs.get(), 64, context,
                 [&](size_t b) { bits[b] = BrickBits::above(level.u.brick(b), threshold); });
  return bits;
}

Labels labels_of(const Level& level, float threshold, const Context& context) {
  return {static_cast<const Domain&>(level), bits_above(level, threshold, context)};
}

Labels labels_of(Level&& level, float threshold, const Context& context) {
  Level freed = std::move(level);
  std::vector<BrickBits> bits = bits_above(freed, threshold, context);
  return {std::move(static_cast<Domain&>(freed)), std::move(bits)};
}

size_t count_inside(const Domain& domain, const std::vector<BrickBits>& bits) {
  size_t total = 0;
  for (const BrickBits& b : bits) total += b.count();
  const LevelBox& box = domain.box;
  const auto free = [&](int axis, const BrickRange& range) {
    const int lo = std::max(box.free_lo[axis], brick_side * range.lo[axis]);
    return static_cast<size_t>(
        std::max(0, std::min(box.free_hi[axis], brick_side * (range.hi[axis] + 1) - 1) - lo + 1));
  };
  const Gaps gaps(domain.grid);
  for (size_t g = 0; g < gaps.size(); ++g)
    if (domain.inside[g]) total += free(0, gaps[g]) * free(1, gaps[g]) * free(2, gaps[g]);
  return total;
}

size_t count_faces(const Labels& labels, const Context& context) {
  const LabelView view = labels.view();
  const BrickGrid& grid = labels.grid;
  const auto faces_of = [&](size_t begin, size_t end) {
    size_t faces = 0;
    for (size_t b = begin; b < end; ++b) {
      const Vec3i coord = grid.coord(b);
      const BrickBits& own = labels.bits[b];
      for (int axis = 0; axis < 3; ++axis) {
        const int slot = slot_up[axis];
        const BrickBits& above = view.of(grid.neighbors(b)[static_cast<size_t>(slot)], coord + slot_offset(slot));
        faces += ((own ^ (moved(own, axis, -1) | carried(above, axis, -1))) & view.joined_to(b, axis, 1)).count();
        Vec3i below = coord;
        --below[axis];
        if (below[axis] >= 0 && grid.find(below) >= 0) continue;
        // The faces below are counted nowhere else; what lies there is constant.
        const bool in = below[axis] >= 0 && labels.inside.test(grid, below);
        faces += inside_lowest((in ? ~own : own) & view.joined_to(b, axis, -1), axis);
      }
    }
    return faces;
  };
  return sum_chunks<size_t>(grid.size(), 1024, context, faces_of);
}

}  // namespace soapfilm
