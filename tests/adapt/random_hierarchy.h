// A random hierarchy of levels: which places have which, and u, p and f of each.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "adapt/ball_levels.h"
#include "soapfilm/adapt/leaf_energy.h"
#include "soapfilm/core/random.h"
#include "soapfilm/pyramid/continue_levels.h"
#include "soapfilm/pyramid/prolong.h"

namespace soapfilm::test {

inline const Context one_thread(1);
inline constexpr int levels = 3;

inline Vec3i up_from(Vec3i v, int axis, int step = 1) {
  v[axis] += step;
  return v;
}

/// A random hierarchy with random u, p and f.
struct Hierarchy {
  Lattice lattice = small_lattice();
  Norm norm;
  Random random;
  Regions regions;
  std::vector<Labels> sides;
  std::vector<SupportField> data;
  std::vector<Level> flux, everywhere;  ///< on bands; in all places

  Hierarchy(uint64_t seed, Norm the_norm, bool open) : norm(the_norm), random(seed) {
    lattice.open = open;
    lattice.below = {7, 7, 7};  // no cell of a coarser level is free in part
    lattice.size = {114, 114, 114};
    regions = random_regions();
    flux.resize(levels);
    everywhere.resize(levels);
    for (int l = 0; l < levels; ++l) {
      sides.push_back(random_sides(l));
      data.push_back(random_data(l));
    }
    for (int l = levels - 1; l >= 0; --l) add_flux(l);
  }

  std::vector<LeafLevel> leaves() const {
    std::vector<LeafLevel> found;
    for (size_t l = 0; l < levels; ++l) found.push_back({&sides[l], &data[l], &flux[l]});
    return found;
  }

  bool chance(double share) { return random.uniform() < share; }

  Regions random_regions() {
    std::vector<BrickMask> finer = {BrickMask(lattice.box(1).bricks), BrickMask(lattice.box(2).bricks)};
    BrickRange::whole(finer[0].bricks()).for_each([&](Vec3i b) {
      if (chance(0.04)) finer[0].set(b);
    });
    finer[0].for_each([&](Vec3i b) {
      for (int slot = 0; slot < 27; ++slot)
        if (const Vec3i n = b + slot_offset(slot); finer[0].contains(n)) finer[1].set(parent_of(n));
    });
    return {finer, finer};
  }

  Labels random_sides(int level) {
    Labels labels;
    labels.box = lattice.box(level);
    labels.grid = BrickGrid(BrickMask::whole(labels.box.bricks), one_thread);
    labels.inside = GapSides(labels.grid);
    labels.bits.resize(labels.grid.size());
    for (size_t b = 0; b < labels.grid.size(); ++b) {
      const double share = random.uniform();
      for_each_vertex(labels.grid.coord(b), [&](Vec3i v, int i) {
        if (labels.box.is_free(v) && chance(share)) labels.bits[b].set(i);
      });
    }
    return labels;
  }

  BrickMask some(int level, double share) {
    BrickMask bricks(lattice.box(level).bricks);
    BrickRange::whole(bricks.bricks()).for_each([&](Vec3i b) {
      if (level == levels - 1 || (regions.is_finer(level + 1, parent_of(b)) && chance(share))) bricks.set(b);
    });
    return bricks;
  }

  SupportField random_data(int level) {
    SupportField field;
    field.grid = BrickGrid(some(level, 0.5), one_thread);
    field.f = Field<float>(field.grid);
    for (size_t b = 0; b < field.grid.size(); ++b)
      for (int i = 0; i < brick_volume; ++i) field.f.brick(b)[i] = static_cast<float>(0.1 * random.normal());
    return field;
  }

  void fill_flux(Level& level) {
    for (size_t b = 0; b < level.grid.size(); ++b)
      for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
        Vec3d p{random.normal(), random.normal(), random.normal()};
        p = p * (static_cast<double>(level.lambda) * random.uniform() / norm_of(p));
        for (int axis = 0; axis < 3; ++axis) {
          const bool exists = !level.box.open || (level.box.is_free(v) && level.box.is_free(up_from(v, axis)));
          level.p.brick(b, axis)[i] = exists ? static_cast<float>(p[axis]) : 0.0f;
        }
      });
  }
  static double norm_of(Vec3d p) { return soapfilm::norm(p); }

  void add_flux(int l) {
    const auto n = static_cast<size_t>(l);
    const LevelBox box = lattice.box(l);
    const float lambda = 0.05f * static_cast<float>(1 << (2 * l));
    if (l == levels - 1) {
      flux[n] = make_level(box, lambda, BrickMask::whole(box.bricks), data[n].grid, data[n].f, one_thread, norm);
      fill_flux(flux[n]);
      everywhere[n] = copy_of(flux[n], one_thread);
      return;
    }
    auto places = std::make_shared<const BrickMask>(some(l, 1));
    BrickMask band(box.bricks);
    some(l, 0.5).for_each([&](Vec3i b) {
      if (flux[n + 1].grid.find(parent_of(b)) >= 0) band.set(b);
    });
    for (size_t b = 0; b < data[n].grid.size(); ++b)
      if (flux[n + 1].grid.find(parent_of(data[n].grid.coord(b))) >= 0) band.set(data[n].grid.coord(b));
    Level state = make_level(box, lambda, *places, data[n].grid, data[n].f, one_thread, norm);
    fill_flux(state);
    const KnownState known{state, [](Vec3i) { return true; }};
    flux[n] = continue_in_places(flux[n + 1], box, band, places, std::span(&known, 1), data[n], one_thread);
    everywhere[n] = prolong_in_places(everywhere[n + 1], box, *places, places, data[n], one_thread, nullptr);
    for (size_t b = 0; b < flux[n].grid.size(); ++b) {
      const auto at = static_cast<size_t>(everywhere[n].grid.find(flux[n].grid.coord(b)));
      std::copy_n(flux[n].p.brick(b), 3 * brick_volume, everywhere[n].p.brick(at));
    }
  }
};

}  // namespace soapfilm::test
