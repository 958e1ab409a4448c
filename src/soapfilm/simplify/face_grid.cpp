#include "soapfilm/simplify/face_grid.h"

#include <fmt/format.h>

#include "soapfilm/error.h"

namespace soapfilm {

FaceGrid::FaceGrid(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& faces)
    : vertices_(vertices), faces_(faces) {
  const auto for_all = [&](auto&& visit) {
    for (uint32_t f = 0; f < faces.size(); ++f)
      for_cells(corner(f, 0), corner(f, 1), corner(f, 2), 0, 1, [&](Vec3i cell) { visit(f, cell); });
  };
  uint64_t total = 0;
  for_all([&](uint32_t, Vec3i cell) {
    const uint32_t block = blocks_.insert(block_key(cell));
    if (block == begins_.size()) begins_.push_back({});
    ++begins_[block][within(cell) + 1];
    ++total;
  });
  if (total >= CellTable::none)
    throw ParameterError(fmt::format("mesh: its {} triangles are in {} cells, must be fewer", faces.size(), total));
  uint32_t sum = 0;
  for (Block& block : begins_) {
    block[0] = sum;
    for (size_t i = 1; i < block.size(); ++i) sum = block[i] += sum;
  }
  in_cells_.resize(sum);
  std::vector<std::array<uint32_t, 64>> next(begins_.size());
  for_all([&](uint32_t f, Vec3i cell) {
    const uint32_t block = blocks_.find(block_key(cell));
    const size_t i = within(cell);
    in_cells_[begins_[block][i] + next[block][i]++] = f;
  });
}

uint32_t FaceGrid::nearest(Vec3d p, double distance) const {
  uint32_t best = CellTable::none;
  double least = distance * distance;
  any_near(p, distance, [&](uint32_t f) {
    const double d = squared_distance(p, f);
    if (d < least || (d == least && f < best)) {
      least = d;
      best = f;
    }
    return false;
  });
  return best;
}

}  // namespace soapfilm
