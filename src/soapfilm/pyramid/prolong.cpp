#include "soapfilm/pyramid/prolong.h"

#include <algorithm>
#include <array>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/device/device.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/grid/window.h"
#include "soapfilm/pyramid/children.h"
#include "soapfilm/solve/level_slabs.h"

namespace soapfilm {

namespace {

/// Beyond an open border u is continued with the values at the border.
void go_on_beyond_border(const Level& coarse, size_t brick, Window<float, 1>& u) {
  const Vec3i first = coarse.grid.first_vertex(brick);
  if (!has_free(coarse.box, coarse.grid.coord(brick))) return;
  for (int z = -1; z <= brick_side; ++z)
    for (int y = -1; y <= brick_side; ++y)
      for (int x = -1; x <= brick_side; ++x) {
        const Vec3i v{x, y, z}, from = nearest_free(coarse.box, first + v) - first;
        if (from != v) u.at(x, y, z) = u.at(from.x, from.y, from.z);
      }
}

/// Trilinear, one axis at a time: a fine vertex is 3/4 the coarse vertex that holds it and 1/4 the nearer neighbor,
/// below for even, above for odd fine vertices.
void prolong_u(const Window<float, 1>& coarse, Vec3i octant, float* fine) {
  constexpr int around = half_brick + 2;  // coarse vertices used by an octant
  const Vec3i first = octant_base(octant) - Vec3i{1, 1, 1};
  const auto near = [](int x) { return 1 + x / 2; };
  const auto far = [](int x) { return x / 2 + 2 * (x & 1); };
  const auto blend = [](float n, float f) { return 0.75f * n + 0.25f * f; };
  float along_x[around][around][brick_side], along_y[around][brick_side][brick_side];
  for (int z = 0; z < around; ++z) {
    for (int y = 0; y < around; ++y) {
      const float* row = &coarse.at(first.x, first.y + y, first.z + z);
      for (int x = 0; x < brick_side; ++x) along_x[z][y][x] = blend(row[near(x)], row[far(x)]);
    }
    for (int y = 0; y < brick_side; ++y)
      for (int x = 0; x < brick_side; ++x) along_y[z][y][x] = blend(along_x[z][near(y)][x], along_x[z][far(y)][x]);
  }
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y)
      for (int x = 0; x < brick_side; ++x)
        fine[brick_offset(x, y, z)] = blend(along_y[near(z)][y][x], along_y[far(z)][y][x]);
}

/// A coarse vertex's upper face is that of its upper children; inside its cell the flux is the mean of its two faces.
template <int axis>
void prolong_p(const CoarseFlux<axis>& coarse, Vec3i octant, float* fine) {
  coarse.for_each_row(octant, [&](int y, int z, const auto& upper, const auto& below) {
    std::array<float, brick_side> rows[2];  // of lower and upper children along y or z; along x the first holds both
    for (size_t x = 0; x < half_brick; ++x) {
      const float within = face_share * (0.5f * (below[x] + upper[x])), top = face_share * upper[x];
      rows[0][2 * x] = within;
      rows[0][2 * x + 1] = axis == 0 ? top : within;
      rows[1][2 * x] = rows[1][2 * x + 1] = top;
    }
    for (int k = 0; k < 4; ++k) {
      const int upper_y = k & 1, upper_z = k >> 1;
      const auto& row = rows[axis == 0 ? 0 : axis == 1 ? upper_y : upper_z];
      std::copy_n(row.data(), brick_side, fine + brick_offset(0, 2 * y + upper_y, 2 * z + upper_z));
    }
  });
}

/// The flux through the low faces of the fine brick in `octant`: exactly a quarter of a matching coarse face.
template <int axis>
void prolong_rim(const CoarseFlux<axis>& coarse, Vec3i octant, float* plane) {
  const Vec3i base = octant_base(octant);
  for (int b = 0; b < brick_side; ++b)
    for (int a = 0; a < brick_side; ++a) {
      Vec3i at = base;
      at[axis == 0 ? 1 : 0] += a / 2;
      at[axis == 2 ? 1 : 2] += b / 2;
      plane[a + brick_side * b] = face_share * coarse.below(at.x, at.y, at.z);
    }
}

/// Prolongs the children of one coarse brick into the fine level.
void prolong_children(const Level& coarse, size_t brick, Level& fine, const Level* previous) {
  const Vec3i parent = coarse.grid.coord(brick);
  Window<float, 1> u;
  bool have_window = false;
  for (int k = 0; k < 8; ++k) {
    const Vec3i octant = octant_of(k);
    const Vec3i child = child_of(parent, octant);
    const int32_t found = fine.grid.find(child);
    if (found < 0) continue;
    const auto b = static_cast<size_t>(found);
    const int32_t old = previous ? previous->grid.find(child) : outside_band;
    for_each_flux(coarse, brick, [&]<int axis>(const CoarseFlux<axis>& flux) {
      if (float* plane = fine.rim.plane(b, axis)) prolong_rim(flux, octant, plane);
      if (old < 0) prolong_p(flux, octant, fine.p.brick(b, axis));
    });
    if (old >= 0) {
      std::copy_n(previous->u.brick(static_cast<size_t>(old)), brick_volume, fine.u.brick(b));
      std::copy_n(previous->p.brick(static_cast<size_t>(old)), 3 * brick_volume, fine.p.brick(b));
      continue;
    }
    if (!have_window) {
      fill_window(
          coarse.grid, brick, [&](int, int32_t n) { return n >= 0 ? coarse.u.brick(static_cast<size_t>(n)) : nullptr; },
          [&](int slot, int32_t n) { return coarse.missing_u(n, parent + slot_offset(slot)); }, u);
      if (coarse.box.open && at_border(coarse.box, parent)) go_on_beyond_border(coarse, brick, u);
      have_window = true;
    }
    prolong_u(u, octant, fine.u.brick(b));
    free_range(fine.box, child).for_each_fixed({}, brick_side, [&](int x, int y, int z) {
      fine.u.brick(b)[brick_offset(x, y, z)] = 0;
    });
  }
}

/// Sets the flux to 0 on faces that an open box does not have: a coarser level's cells may extend beyond the border.
void cut_off_flux(Level& level, const Context& context) {
  const ItemRange bricks = bricks_at_hand(level);
  parallel_for(context, bricks.size(), 64, [&](size_t k) {
    const size_t b = bricks.begin + k;
    if (!at_border(level.box, level.grid.coord(b))) return;
    for (int axis = 0; axis < 3; ++axis) {
      float* p = level.p.brick(b, axis);
      float* plane = level.rim.plane(b, axis);
      for (int i = 0; i < brick_volume; ++i) {
        const Vec3i local{i % brick_side, i / brick_side % brick_side, i / brick_area};
        const Vec3i v = level.grid.first_vertex(b) + local;
        Vec3i up = v, down = v;
        ++up[axis], --down[axis];
        if (!level.box.is_free(v) || !level.box.is_free(up)) p[i] = 0;
        if (plane && local[axis] == 0 && (!level.box.is_free(v) || !level.box.is_free(down)))
          plane[local[axis == 0 ? 1 : 0] + brick_side * local[axis == 2 ? 1 : 2]] = 0;
      }
    }
  });
}

/// The state of the children of one coarse brick that are not in the fine band.
struct LeftOut {
  std::array<OutsideTerms, 8> outside;
  uint8_t inside = 0;  // a bit per child, also for those in the band
};

LeftOut left_out_children(const Level& coarse, size_t brick, const Level& fine, const SupportField& support) {
  LeftOut children;
  for (int k = 0; k < 8; ++k) {
    const Vec3i octant = octant_of(k);
    if (fine.box.open && !has_free(fine.box, child_of(coarse.grid.coord(brick), octant))) continue;
    if (inside_child(coarse, brick, octant)) children.inside |= static_cast<uint8_t>(1 << k);
    if (fine.grid.find(child_of(coarse.grid.coord(brick), octant)) < 0)
      children.outside[static_cast<size_t>(k)] = outside_child(coarse, brick, octant, support);
  }
  return children;
}

/// Frees the memory below a layer along z.
void give_back_below(Level& level, int z) {
  const size_t end = level.grid.bricks_below(z);
  level.u.release_before(end);
  level.p.release_before(end);
}

/// For the children of a coarse layer, and of the next one, as large pages extend across both: uses pages that the
/// coarse level has freed.
void supply_pages(Level& fine, int coarse_z) {
  const size_t begin = fine.grid.bricks_below(2 * coarse_z), end = fine.grid.bricks_below(2 * coarse_z + 4);
  if (begin == end) return;
  fine.u.supply_pages(begin, end);
  fine.p.supply_pages(begin, end);
}

/// Of the bricks that a level covers and its grid lacks those on the inside.
GapSides sides_in_places(const Level& coarse, const Level& fine) {
  BrickMask inside(fine.box.bricks);
  fine.places->for_each([&](Vec3i child) {
    if (fine.grid.find(child) >= 0 || !has_free(fine.box, child)) return;
    const Vec3i parent = parent_of(child);
    const int32_t slot = coarse.grid.find(parent);
    if (slot >= 0 ? inside_child(coarse, static_cast<size_t>(slot), octant_in_parent(child))
                  : coarse.is_inside(slot, parent))
      inside.set(child);
  });
  return GapSides(std::move(inside));
}

/// The coarse layers that a slab of the fine level and the layers next to it are prolonged from.
Layers parents_of(Layers fine) {
  const Layers at_hand = fine.widened(1, 1);
  return {at_hand.begin >> 1, ((at_hand.end - 1) >> 1) + 1};
}

/// Brings what a rank needs of the coarse level and of the previous one, which may be null.
void bring_sources(const Level& coarse, const Level* previous, const Level& fine) {
  const auto bring_layers = [&](const Level& level, auto&& needed) {
    if (!level.slabs) return;
    const ItemRange all{0, level.grid.size()};
    bring_bricks(level, fine.slabs
                            ? fine.slabs->parts([&](Layers layers) { return bricks_of(level.grid, needed(layers)); })
                            : std::vector<ItemRange>(level.slabs->count(), all));
  };
  bring_layers(coarse, [](Layers layers) { return parents_of(layers).widened(1, 1); });
  if (previous) bring_layers(*previous, [](Layers layers) { return layers.widened(1, 1); });
}

/// The fine level without its state.
Level make_finer(const Level& coarse, const LevelBox& box, const BrickMask& band, const SupportField& support,
                 const Context& context) {
  Level fine = make_level(box, 0.25f * coarse.lambda, band, support.grid, support.f, context, coarse.norm);
  fine.slabs = Slabs::of(fine.grid, context);
  return fine;
}

/// Prolongs by slices of coarse bricks; used(z) is called when nothing of the coarse level below layer z is read any
/// more, and of the previous level no child of layer z. Of a level in slabs those that this rank needs.
template <class Used>
Level prolong_layers(const Level& coarse, Level fine, const SupportField& support, const Context& context,
                     const Level* previous, Used&& used) {
  const LevelBox& box = fine.box;
  std::vector<LeftOut> left_out(fine.places ? 0 : coarse.grid.size());
  if (fine.slabs)
    for_each_item(
        left_out, fine.slabs.get(), 16, context, [&](size_t b) { return 2 * coarse.grid.coord(b).z; },
        [&](size_t b) { left_out[b] = left_out_children(coarse, b, fine, support); });
  const Layers layers = fine.slabs ? parents_of(fine.slabs->own()) : Layers{0, coarse.box.bricks.z};
  const Device* device = fine.places || fine.slabs ? nullptr : device_of(context);
  const bool prolonged = device && device->prolong_state(coarse, previous, fine, context);
  for (const BrickGrid::Slice& slice : coarse.grid.slices()) {
    if (slice.z < layers.begin || slice.z >= layers.end) continue;
    supply_pages(fine, slice.z);
    parallel_for(context, slice.end - slice.begin, 16, [&, first = slice.begin](size_t i) {
      if (!prolonged) prolong_children(coarse, first + i, fine, previous);
      if (!fine.places && !fine.slabs) left_out[first + i] = left_out_children(coarse, first + i, fine, support);
    });
    used(slice.z);
  }
  if (box.open && box.level >= same_border_levels) cut_off_flux(fine, context);
  if (fine.places) {
    fine.inside = sides_in_places(coarse, fine);
    return fine;
  }
  fine.inside = GapSides(fine.grid, bricks_with_free(box), [&](Vec3i child) {
    const Vec3i parent = parent_of(child);
    const int32_t slot = coarse.grid.find(parent);
    if (slot < 0) return coarse.inside.test(coarse.grid, slot, parent);
    const Vec3i octant = octant_in_parent(child);
    return (left_out[static_cast<size_t>(slot)].inside >> (octant.x + 2 * octant.y + 4 * octant.z) & 1) != 0;
  });
  fine.outside = coarse.outside;
  TileSums<OutsideTerms> outside;
  for (size_t b = 0; b < coarse.grid.size(); ++b)
    for (int k = 0; k < 8; ++k) outside.add(coarse.grid.coord(b), left_out[b].outside[static_cast<size_t>(k)]);
  fine.outside += outside.total();
  return fine;
}

}  // namespace

Level prolong_level(const Level& coarse, const LevelBox& box, const BrickMask& band, const SupportField& support,
                    const Context& context) {
  Level fine = make_finer(coarse, box, band, support, context);
  bring_sources(coarse, nullptr, fine);
  return prolong_layers(coarse, std::move(fine), support, context, nullptr, [](int) {});
}

Level prolong_level(const Level& coarse, const LevelBox& box, const BrickMask& band, const SupportField& support,
                    const Context& context, Level&& previous) {
  Level fine = make_finer(coarse, box, band, support, context);
  bring_sources(coarse, &previous, fine);
  return prolong_layers(coarse, std::move(fine), support, context, &previous,
                        [&](int z) { give_back_below(previous, 2 * z + 2); });
}

Level prolong_in_places(const Level& coarse, const LevelBox& box, const BrickMask& band,
                        std::shared_ptr<const BrickMask> places, const SupportField& support, const Context& context,
                        Level* previous) {
  Level fine = make_level(box, 0.25f * coarse.lambda, band, support.grid, support.f, context, coarse.norm);
  fine.places = std::move(places);
  return prolong_layers(coarse, std::move(fine), support, context, previous, [&](int z) {
    if (previous) give_back_below(*previous, 2 * z + 2);
  });
}

Level prolong_level(Level&& coarse, const LevelBox& box, const BrickMask& band, const SupportField& support,
                    const Context& context) {
  Level fine = make_finer(coarse, box, band, support, context);
  bring_sources(coarse, nullptr, fine);
  // The next layer reads this one through its low faces and windows.
  return prolong_layers(coarse, std::move(fine), support, context, nullptr, [&](int z) { give_back_below(coarse, z); });
}

}  // namespace soapfilm
