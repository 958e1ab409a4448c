#include "soapfilm/adapt/levels_of_sides.h"

#include <memory>
#include <utility>

#include "soapfilm/adapt/surroundings.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

namespace {

/// One level's sides, brick by brick. `finer`: the labels of the next finer level, where there is one.
class SidesOfLevel {
 public:
  SidesOfLevel(const LeafLinks& links, const LeafSet& inside, int level, const Labels* finer)
      : links_(links), inside_(inside), finer_(finer), level_(level) {}

  BrickBits of(Vec3i brick) const {
    if (!links_.regions().is_finer(level_, brick)) {
      const size_t b = links_.find(level_, brick);
      return b == links_.bricks() ? BrickBits{} : inside_.bits[b];
    }
    if (is_between(brick)) return finer_->of(child_of(brick, 0)).any() ? BrickBits::full() : BrickBits{};
    return most_of_children(*finer_, brick);
  }

 private:
  /// Whether the finer level has one side there.
  bool is_between(Vec3i brick) const {
    for (int k = 0; k < 8; ++k)
      if (finer_->grid.find(child_of(brick, k)) >= 0) return false;
    return true;
  }

  const LeafLinks& links_;
  const LeafSet& inside_;
  const Labels* finer_;
  int level_;
};

/// The bricks with both sides, and those inside, of a level's places.
struct Contents {
  BrickMask mixed, ones;
};

Contents contents_of(const SidesOfLevel& sides, const LevelBox& box, const BrickMask* places) {
  Contents found{BrickMask(box.bricks), BrickMask(box.bricks)};
  const auto add = [&](Vec3i b) {
    const BrickBits bits = sides.of(b);
    if (!bits.any()) return;
    (bits == BrickBits::full() ? found.ones : found.mixed).set(b);
  };
  if (places)
    places->for_each(add);
  else
    BrickRange::whole(box.bricks).for_each(add);
  return found;
}

/// Those, and bricks beside another side.
BrickMask near_surface(const Contents& contents, const LevelBox& box, const BrickMask* places) {
  BrickMask near(box.bricks);
  const auto in_places = [&](Vec3i b) { return near.contains(b) && (!places || places->test(b)); };
  contents.mixed.for_each([&](Vec3i b) {
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i beside = b + slot_offset(slot); in_places(beside)) near.set(beside);
  });
  contents.ones.for_each([&](Vec3i b) {
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i beside = b + slot_offset(slot);
      const bool beyond = !near.contains(beside);
      if (!beyond && (!in_places(beside) || contents.ones.test(beside))) continue;
      near.set(b);
      if (!beyond) near.set(beside);
    }
  });
  return near;
}

Level level_of_sides(const SidesOfLevel& sides, const Level& like, const SupportField& data, const Context& context) {
  const BrickMask* places = like.places.get();
  const Contents contents = contents_of(sides, like.box, places);
  BrickMask bricks = near_surface(contents, like.box, places);
  for (size_t k = 0; k < data.grid.size(); ++k)
    if (const Vec3i b = data.grid.coord(k); like.covers(b)) bricks.set(b);
  Level level = make_level(like.box, like.lambda, bricks, data.grid, data.f, context, like.norm);
  level.places = like.places;
  parallel_for(context, level.grid.size(), 64, [&](size_t b) {
    float* u = level.u.brick(b);
    sides.of(level.grid.coord(b)).for_each([&](int i) { u[i] = 1; });
  });
  if (!places) {
    level.inside = GapSides(level.grid, bricks_with_free(level.box), [&](Vec3i b) { return contents.ones.test(b); });
    return level;
  }
  BrickMask inside(level.box.bricks);
  contents.ones.for_each([&](Vec3i b) {
    if (level.grid.find(b) < 0) inside.set(b);
  });
  level.inside = GapSides(std::move(inside));
  return level;
}

}  // namespace

std::vector<Level> levels_of_sides(const LeafLinks& links, const LeafSet& inside, std::span<const SupportField> data,
                                   Norm norm, const Context& context) {
  std::vector<Level> levels;
  Labels finer;
  for (int l = 0; l < links.levels(); ++l) {
    Level like;
    like.box = links.box(l);
    like.lambda = static_cast<float>(links.lambda(l));
    like.norm = norm;
    if (l + 1 < links.levels())
      like.places = std::make_shared<const BrickMask>(children_of(links.regions().finer(l + 1), like.box.bricks));
    const SidesOfLevel sides(links, inside, l, l > 0 ? &finer : nullptr);
    levels.push_back(level_of_sides(sides, like, data[static_cast<size_t>(l)], context));
    finer = labels_of(levels.back(), 0.5f, context);
  }
  return levels;
}

}  // namespace soapfilm
