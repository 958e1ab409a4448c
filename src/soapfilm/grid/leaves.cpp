#include "soapfilm/grid/leaves.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

LeafAt in(const BrickGrid& grid, Vec3i vertex, LeafAt::Kind kind) {
  const int32_t brick = grid.find(brick_of(vertex));
  if (brick < 0) return {};
  return {kind, brick, brick_offset(vertex.x & 7, vertex.y & 7, vertex.z & 7)};
}

[[noreturn]] void refuse(Vec3i brick, int level, const char* does, size_t other, const char* must) {
  throw ParameterError(fmt::format("brick ({}, {}, {}) of level {} {} one of level {}, must {}", brick.x, brick.y,
                                   brick.z, level, does, other, must));
}

void check_brick(LeafLevels levels, int level, Vec3i brick) {
  std::array<Vec3i, 27> ancestors;
  for (int slot = 0; slot < 27; ++slot) ancestors[static_cast<size_t>(slot)] = brick + slot_offset(slot);
  const auto own = static_cast<size_t>(level);
  for (size_t l = own + 1; l < levels.size(); ++l) {
    for (Vec3i& ancestor : ancestors) ancestor = parent_of(ancestor);
    const auto is_leaf = [&](Vec3i ancestor) { return levels[l]->find(ancestor) >= 0; };
    if (is_leaf(ancestors[static_cast<size_t>(neighbor_slot(0, 0, 0))])) refuse(brick, level, "lies in", l, "not");
    if (l > own + 1 && std::any_of(ancestors.begin(), ancestors.end(), is_leaf))
      refuse(brick, level, "touches", l, "touch levels next to its own");
  }
}

}  // namespace

LeafAt leaf_at(LeafLevels levels, int level, Vec3i vertex) {
  const auto l = static_cast<size_t>(level);
  if (const LeafAt own = in(*levels[l], vertex, LeafAt::Kind::leaf); own.brick >= 0) return own;
  if (l + 1 < levels.size())
    if (const LeafAt above = in(*levels[l + 1], parent_of(vertex), LeafAt::Kind::coarser); above.brick >= 0)
      return above;
  if (l > 0)
    if (const LeafAt below = in(*levels[l - 1], vertex * 2, LeafAt::Kind::finer); below.brick >= 0) return below;
  return {};
}

void check_leaves(LeafLevels levels) {
  for (size_t l = 0; l < levels.size(); ++l)
    for (size_t b = 0; b < levels[l]->size(); ++b) check_brick(levels, static_cast<int>(l), levels[l]->coord(b));
}

}  // namespace soapfilm
