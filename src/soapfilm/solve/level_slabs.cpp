#include "soapfilm/solve/level_slabs.h"

namespace soapfilm {

namespace {

constexpr size_t u_bytes = brick_volume * sizeof(float), plane_bytes = brick_area * sizeof(float);

std::vector<ItemRange> owned_bricks(const Level& level) {
  return level.slabs->parts([&](Layers layers) { return bricks_of(level.grid, layers); });
}

void bring_state(Level& level, const std::vector<ItemRange>& wanted) {
  bring(level.slabs->ranks(), owned_bricks(level), wanted,
        {{level.u.brick(0), u_bytes}, {level.p.brick(0), 3 * u_bytes}});
}

}  // namespace

void bring_bricks(const Level& of_ranks, const std::vector<ItemRange>& wanted) {
  auto& level = const_cast<Level&>(of_ranks);  // what others own is written
  bring_state(level, wanted);
  std::vector<ItemRange> planes, wanted_planes;
  for (const ItemRange& part : owned_bricks(level)) planes.push_back(level.rim.planes(part));
  for (const ItemRange& part : wanted) wanted_planes.push_back(level.rim.planes(part));
  bring(level.slabs->ranks(), planes, wanted_planes, {{level.rim.flux().data(), plane_bytes}});
}

void bring_borders(Level& level) {
  bring_state(level, level.slabs->parts([&](Layers layers) { return bricks_of(level.grid, layers.widened(1, 1)); }));
}

void complete(Level& level) {
  if (!level.slabs) return;
  bring_bricks(level, std::vector<ItemRange>(level.slabs->count(), ItemRange{0, level.grid.size()}));
  level.slabs = nullptr;
}

}  // namespace soapfilm
