#include "soapfilm/pyramid/band.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/pyramid/children.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

namespace {

constexpr unsigned all_octants = 0xFF;

unsigned octants_of(const BrickBits& bits) {
  constexpr uint64_t corner = 0x0F0F0F0F;  // of a layer: its lowest 4 x 4 vertices
  unsigned octants = 0;
  for (int half = 0; half < 2; ++half) {
    uint64_t layers = 0;
    for (size_t z = 0; z < half_brick; ++z) layers |= bits.layer[static_cast<size_t>(half) * half_brick + z];
    for (int k = 0; k < 4; ++k)
      if ((layers >> (half_brick * (k & 1) + brick_side * half_brick * (k >> 1)) & corner) != 0)
        octants |= 1u << (k + 4 * half);
  }
  return octants;
}

/// The children within two fine vertices of the interface, so that it can move.
BrickMask beside_interface(const Level& coarse, const std::vector<BrickBits>& interface, Vec3i fine_bricks,
                           const Context& context) {
  BrickMask mask(fine_bricks);
  parallel_for(context, coarse.grid.size(), 64, [&](size_t b) {
    uint64_t near = 0;  // of 4 x 4 x 4 octants, one of them below the brick
    interface[b].for_each([&](int vertex) {
      const int x = vertex % brick_side, y = vertex / brick_side % brick_side, z = vertex / brick_area;
      for (const int oz : {z - 1, z + 1})
        for (const int oy : {y - 1, y + 1})
          for (const int ox : {x - 1, x + 1})
            near |= uint64_t{1} << ((ox + half_brick) / half_brick + 4 * ((oy + half_brick) / half_brick) +
                                    16 * ((oz + half_brick) / half_brick));
    });
    for (; near != 0; near &= near - 1) {
      const int k = std::countr_zero(near);
      const Vec3i child = coarse.grid.coord(b) * 2 + Vec3i{(k & 3) - 1, (k >> 2 & 3) - 1, (k >> 4) - 1};
      if (mask.contains(child)) mask.set_shared(child);
    }
  });
  return mask;
}

/// Octants with a vertex where the prolonged dual might leave the ball. It cannot leave the cube of the anisotropic
/// norm: its components are means of feasible ones.
unsigned infeasible_octants(const Level& level, size_t brick) {
  if (level.norm == Norm::anisotropic) return 0;
  std::array<std::array<double, octant_volume>, 8> bound{};
  for_each_flux(level, brick, [&](const auto& flux) {
    for (int k = 0; k < 8; ++k)
      flux.for_each_row(octant_of(k), [&](int y, int z, const auto& here, const auto& below) {
        double* sum = bound[static_cast<size_t>(k)].data() + octant_offset(0, y, z);
        for (size_t x = 0; x < here.size(); ++x) {
          const double upper = here[x], lower = below[x];
          sum[x] += std::max(lower * lower, upper * upper);
        }
      });
  });
  const double lambda_squared = static_cast<double>(level.lambda) * level.lambda;
  unsigned octants = 0;
  for (size_t k = 0; k < bound.size(); ++k)
    if (std::any_of(bound[k].begin(), bound[k].end(), [&](double sum) { return sum > lambda_squared; }))
      octants |= 1u << k;
  return octants;
}

/// The children with a part of the interface, or where the prolonged dual might leave the ball.
BrickMask interface_children(const Level& coarse, const std::vector<BrickBits>& interface, Vec3i fine_bricks,
                             const Context& context) {
  std::vector<uint8_t> octants(coarse.grid.size());
  for_each_brick(octants, coarse.grid, coarse.slabs.get(), 64, context, [&](size_t b) {
    unsigned found = octants_of(interface[b]);
    if (found != all_octants) found |= infeasible_octants(coarse, b);
    octants[b] = static_cast<uint8_t>(found);
  });
  BrickMask mask(fine_bricks);
  parallel_for(context, octants.size(), 64, [&](size_t b) {
    for (int k = 0; k < 8; ++k)
      if (octants[b] >> k & 1u) mask.set_shared(child_of(coarse.grid.coord(b), k));
  });
  return mask;
}

bool is_free(const FreeRange& range, int offset) {
  return range.contains(offset % brick_side, offset / brick_side % brick_side, offset / brick_area);
}

/// Where the coarser level's cells extend beyond an open border its flux through the border is set to 0: the vertices
/// there must be in the band. (Children of bricks that were never in a band have none.) Below, cells end at the border
/// unless the lattice is anchored.
void add_border(const LevelBox& box, const Level& coarse, BrickMask& band) {
  const BrickRange free = bricks_with_free(box);
  const auto is_cut = [&](Vec3i child) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool cut_below = 2 * coarse.box.free_lo[axis] < box.free_lo[axis];
      if (child[axis] == free.hi[axis] || (cut_below && child[axis] == free.lo[axis])) return true;
    }
    return false;
  };
  for (size_t b = 0; b < coarse.grid.size(); ++b)
    for (int k = 0; k < 8; ++k)
      if (const Vec3i child = child_of(coarse.grid.coord(b), k); free.contains(child) && is_cut(child)) band.set(child);
}

/// Of each brick.
std::vector<BrickBits> interfaces(const Level& level, const Context& context) {
  return LabelView(level, bits_above(level, 0.5f, context)).interfaces(context);
}

}  // namespace

BrickMask start_bricks(const LevelBox& box, const BrickGrid& support, double most) {
  constexpr double few = 64;     // bricks that are always cheap, 32^3 vertices
  constexpr size_t many = 1024;  // of data; a level without a band has this many where samples are scattered
  BrickMask mask(box.bricks);
  add_bricks(support, mask);
  const BrickRange free =
      BrickRange{brick_of(box.free_lo - Vec3i{1, 1, 1}), brick_of(box.free_hi + Vec3i{1, 1, 1})}.common(
          BrickRange::whole(box.bricks));
  const double limit = std::max(few, most * static_cast<double>(std::min(support.size(), many)));
  if (free.count() <= limit) {
    free.for_each([&](Vec3i b) { mask.set(b); });
    return mask;
  }
  // Blocks of 2^size bricks along each axis that hold bricks of the data or bricks next to these.
  const auto blocks_of = [&](int size) {
    const auto block = [size](Vec3i b) { return Vec3i{b.x >> size, b.y >> size, b.z >> size}; };
    BrickMask blocks(block(box.bricks) + Vec3i{1, 1, 1});
    for (size_t b = 0; b < support.size(); ++b)
      for (int slot = 0; slot < 27; ++slot)
        if (const Vec3i near = support.coord(b) + slot_offset(slot); free.contains(near)) blocks.set(block(near));
    return blocks;
  };
  int size = 0;
  BrickMask blocks = blocks_of(size);
  for (;;) {
    BrickMask larger = blocks_of(size + 1);
    if (static_cast<double>(larger.count()) * std::ldexp(1, 3 * (size + 1)) > limit) break;
    blocks = std::move(larger);
    ++size;
  }
  blocks.for_each([&](Vec3i block) {
    const Vec3i first = block * (1 << size), last = first + Vec3i{1, 1, 1} * ((1 << size) - 1);
    BrickRange{first, last}.common(free).for_each([&](Vec3i b) { mask.set(b); });
  });
  return mask;
}

BrickMask choose_band(const Level& coarse, const LevelBox& box, const SupportField& support, double allowed,
                      const Context& context) {
  const std::vector<BrickBits> interface = interfaces(coarse, context);
  BrickMask band = interface_children(coarse, interface, box.bricks, context);
  if (box.open && box.level >= same_border_levels) add_border(box, coarse, band);
  if (box.level > 0) {
    add_bricks(support.grid, band);
    return band;
  }
  std::vector<double> gap(support.grid.size());
  const auto z_of_parent = [&](size_t b) { return support.grid.coord(b).z >> 1; };
  for_each_item(gap, coarse.slabs.get(), 64, context, z_of_parent, [&](size_t b) {
    const Vec3i c = support.grid.coord(b);
    if (band.test(c)) return;
    const auto parent = static_cast<size_t>(coarse.grid.find(parent_of(c)));
    gap[b] = outside_child(coarse, parent, octant_in_parent(c), support).gap;
  });
  const BrickMask beside = beside_interface(coarse, interface, box.bricks, context);
  std::vector<size_t> candidates;
  for (size_t b = 0; b < gap.size(); ++b) {
    const Vec3i c = support.grid.coord(b);
    if (beside.test(c))
      band.set(c);
    else if (!band.test(c))
      candidates.push_back(b);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [&](size_t a, size_t b) { return gap[a] < gap[b]; });
  double sum = 0;
  for (const size_t b : candidates)
    if ((sum += gap[b]) > allowed) band.set(support.grid.coord(b));
  return band;
}

BrickMask choose_band_in(const BrickMask& places, const Level& coarse, const LevelBox& box, const SupportField& support,
                         const Context& context) {
  const BrickMask near = interface_children(coarse, interfaces(coarse, context), box.bricks, context);
  BrickMask band(box.bricks);
  near.for_each([&](Vec3i b) {
    if (places.test(b)) band.set(b);
  });
  for (size_t b = 0; b < support.grid.size(); ++b)
    if (const Vec3i at = support.grid.coord(b); places.test(at) && coarse.grid.find(parent_of(at)) >= 0) band.set(at);
  return band;
}

BrickMask growth(const Level& level, const BrickGrid* coarse, const Context& context) {
  std::vector<uint8_t> grows(level.grid.size());  // a bit for each side
  for_each_brick(grows, level.grid, level.slabs.get(), 64, context, [&](size_t b) {
    const float* u = level.u.brick(b);
    const FreeRange range = free_range(level.box, level.grid.coord(b));
    const bool ends = level.box.open && !range.whole();
    for (int axis = 0; axis < 3; ++axis)
      for (int up = 0; up <= 1; ++up) {
        const int slot = up ? slot_up[axis] : slot_down[axis];
        if (level.grid.neighbors(b)[static_cast<size_t>(slot)] != outside_band) continue;
        const Vec3i next = level.grid.coord(b) + slot_offset(slot);
        if (!level.covers(next) || (coarse && coarse->find(parent_of(next)) < 0)) continue;
        if (level.box.open && !has_free(level.box, next)) continue;
        const bool outside_is_inside = level.inside.test(level.grid, outside_band, next);
        const auto [first, second] = strides_across(axis);
        const float* layer = u + (up ? (brick_side - 1) * brick_stride[axis] : 0);
        bool reached = false;
        for (int k = 0; k < brick_area && !reached; ++k) {
          const int offset = k % brick_side * first + k / brick_side * second;
          if (ends && !is_free(range, offset + static_cast<int>(layer - u))) continue;
          reached = (layer[offset] > 0.5f) != outside_is_inside;
        }
        if (reached) grows[b] |= static_cast<uint8_t>(1 << (2 * axis + up));
      }
  });
  BrickMask grown(level.box.bricks);
  for (size_t b = 0; b < grows.size(); ++b)
    for (int side = 0; side < 6 && grows[b] != 0; ++side)
      if (grows[b] >> side & 1)
        grown.set(level.grid.coord(b) + slot_offset(side % 2 == 1 ? slot_up[side / 2] : slot_down[side / 2]));
  return grown;
}

BrickMask widened(const BrickMask& band, const BrickGrid& coarse) {
  BrickMask wide = band;
  band.for_each([&](Vec3i b) {
    for (int axis = 0; axis < 3; ++axis)
      for (const int slot : {slot_down[axis], slot_up[axis]}) {
        const Vec3i next = b + slot_offset(slot);
        if (coarse.find(parent_of(next)) >= 0) wide.set(next);
      }
  });
  return wide;
}

}  // namespace soapfilm
