#include "soapfilm/grid/slabs.h"

#include "soapfilm/core/context_state.h"

namespace soapfilm {

namespace {

constexpr int beyond_all = 1 << 28;  // layers

bool are_thick(const BrickGrid& grid, const Ranks& ranks) {
  return grid.slices().size() >= static_cast<size_t>(ranks.least_layers()) * static_cast<size_t>(ranks.count());
}

}  // namespace

std::shared_ptr<const Slabs> Slabs::of(const BrickGrid& grid, const Context& context) {
  const std::shared_ptr<Ranks>& ranks = context.state().ranks;
  if (!ranks || ranks->count() == 1 || !are_thick(grid, *ranks)) return nullptr;
  std::vector<size_t> bricks(static_cast<size_t>(grid.bricks().z));
  for (const BrickGrid::Slice& slice : grid.slices()) bricks[static_cast<size_t>(slice.z)] = slice.end - slice.begin;
  const std::vector<size_t> cut = ranks->cut(bricks);
  std::vector<int> layers(cut.begin(), cut.end());
  layers.back() = beyond_all;
  return std::make_shared<const Slabs>(ranks, std::move(layers));
}

std::shared_ptr<const Slabs> Slabs::halved() const {
  std::vector<int> cut = cut_;
  for (int& layer : cut) layer >>= 1;
  cut.back() = beyond_all;
  return std::make_shared<const Slabs>(ranks_, std::move(cut));
}

bool Slabs::suit(const BrickGrid& grid) const { return are_thick(grid, *ranks_); }

}  // namespace soapfilm
