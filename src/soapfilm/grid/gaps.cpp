#include "soapfilm/grid/gaps.h"

#include <algorithm>

namespace soapfilm {

void Gaps::add_strip(BrickRange range) {
  if (!range.empty()) strips_.push_back({range.lo.y, range.hi.y, gaps_.size(), gaps_.size() + 1});
  gaps_.push_back(range);
}

Gaps::Gaps(const BrickGrid& grid) {
  gaps_.reserve(grid.gaps());
  const Vec3i last = grid.bricks() - Vec3i{1, 1, 1};
  const auto add_empty_slices = [&](int lo, int hi) {
    const size_t begin = strips_.size();
    add_strip({{0, 0, lo}, {last.x, last.y, hi}});
    if (strips_.size() > begin) plates_.push_back({lo, hi, begin, strips_.size()});
  };
  int z = 0;
  for (const BrickGrid::Slice& slice : grid.slices()) {
    add_empty_slices(z, slice.z - 1);
    z = slice.z;
    const size_t begin = strips_.size();
    int y = 0;
    for (size_t r = slice.first_row; r < slice.end_row; ++r) {
      const BrickGrid::Row& row = grid.rows()[r];
      add_strip({{0, y, z}, {last.x, row.y - 1, z}});
      strips_.push_back({row.y, row.y, gaps_.size(), gaps_.size() + row.end - row.begin + 1});
      int x = 0;
      for (size_t b = row.begin; b < row.end; ++b) {
        gaps_.push_back({{x, row.y, z}, {grid.coord(b).x - 1, row.y, z}});
        x = grid.coord(b).x + 1;
      }
      gaps_.push_back({{x, row.y, z}, {last.x, row.y, z}});
      y = row.y + 1;
    }
    add_strip({{0, y, z}, {last.x, last.y, z}});
    plates_.push_back({z, z, begin, strips_.size()});
    ++z;
  }
  add_empty_slices(z, last.z);
}

size_t count_vertices(const BrickRange& range) {
  constexpr double most = 0x1p48;
  return static_cast<size_t>(std::min(most, brick_volume * range.count()));
}

size_t GapSides::count(const BrickGrid& grid) const {
  if (by_brick_) {
    size_t bricks = 0;
    by_brick_->for_each([&](Vec3i b) { bricks += grid.find(b) == outside_band; });
    return bricks * brick_volume;
  }
  const Gaps gaps(grid);
  size_t vertices = 0;
  for (size_t g = 0; g < gaps.size(); ++g)
    if (inside_[g] != 0) vertices += count_vertices(gaps[g]);
  return vertices;
}

double shared_faces(const BrickRange& a, const BrickRange& b) {
  double faces = 1;
  int apart = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int common = std::min(a.hi[axis], b.hi[axis]) - std::max(a.lo[axis], b.lo[axis]) + 1;
    if (common < 0) return 0;
    if (common == 0)
      ++apart;
    else
      faces *= common;
  }
  return apart == 1 && !a.empty() && !b.empty() ? faces : 0;
}

double faces_at_end(const BrickRange& range, const BrickRange& box) {
  if (range.empty()) return 0;
  double faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double across = range.count() / (double{1} + range.hi[axis] - range.lo[axis]);
    faces += (range.lo[axis] == box.lo[axis] ? across : 0) + (range.hi[axis] == box.hi[axis] ? across : 0);
  }
  return faces;
}

}  // namespace soapfilm
