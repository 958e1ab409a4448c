#include "soapfilm/extract/drawn_cells.h"

#include <algorithm>

namespace soapfilm {

namespace {

constexpr int reach = brick_side + 2;  // vertices -1 to 8: the cells around the brick's edges touch them
constexpr int cells = brick_side + 1;  // cells -1 to 7

/// Rows of bits along x, from -1 on; [z + 1][y + 1].
using VertexRows = std::array<std::array<uint16_t, reach>, reach>;

/// The part of a window of vertices -1 to 8 along one axis that the neighbor `step` (-1, 0 or 1) gives.
struct Span {
  int first, last;
};
constexpr Span span_of(int step) {
  return step < 0 ? Span{-1, 0} : step == 0 ? Span{0, brick_side} : Span{brick_side, brick_side + 1};
}

VertexRows known_vertices(const BrickGrid& grid, const Field<float>& weight, Vec3i brick) {
  VertexRows known{};
  for (int slot = 0; slot < 27; ++slot) {
    const Vec3i step = slot_offset(slot);
    const int32_t from = grid.find(brick + step);
    if (from < 0) continue;
    const float* values = weight.brick(static_cast<size_t>(from));
    const Span sx = span_of(step.x), sy = span_of(step.y), sz = span_of(step.z);
    for (int z = sz.first; z < sz.last; ++z) {
      for (int y = sy.first; y < sy.last; ++y) {
        const float* row = values + brick_offset(0, y & 7, z & 7);
        unsigned bits = 0;
        for (int x = sx.first; x < sx.last; ++x) bits |= static_cast<unsigned>(row[x & 7] > 0) << (x + 1);
        known[z + 1][y + 1] = static_cast<uint16_t>(known[z + 1][y + 1] | bits);
      }
    }
  }
  return known;
}

VertexRows vertices_within(Vec3i lo, Vec3i hi, Vec3i brick) {
  const Vec3i first = brick * brick_side - Vec3i{1, 1, 1};
  unsigned along_x = 0;
  for (int x = 0; x < reach; ++x) along_x |= static_cast<unsigned>(first.x + x >= lo.x && first.x + x <= hi.x) << x;
  VertexRows rows{};
  for (int z = std::max(0, lo.z - first.z); z < std::min(reach, hi.z - first.z + 1); ++z)
    for (int y = std::max(0, lo.y - first.y); y < std::min(reach, hi.y - first.y + 1); ++y)
      rows[z][y] = static_cast<uint16_t>(along_x);
  return rows;
}

std::array<std::array<uint16_t, cells>, cells> known_cells(const VertexRows& known) {
  std::array<std::array<uint16_t, cells>, cells> rows;
  for (int z = 0; z < cells; ++z) {
    for (int y = 0; y < cells; ++y) {
      const int corners = known[z][y] & known[z][y + 1] & known[z + 1][y] & known[z + 1][y + 1];
      rows[z][y] = static_cast<uint16_t>(corners & corners >> 1);
    }
  }
  return rows;
}

}  // namespace

DrawnCells::DrawnCells() {
  for (auto& layer : cells) layer.fill(0xff);
  edges.fill(~uint64_t{0});
  split.fill(0);
}

DrawnCells::DrawnCells(const BrickGrid& grid, const Field<float>& weight, Vec3i brick) {
  draw(known_cells(known_vertices(grid, weight, brick)));
}

DrawnCells::DrawnCells(Vec3i lo, Vec3i hi, Vec3i brick) { draw(known_cells(vertices_within(lo, hi, brick))); }

void DrawnCells::draw(const CellRows& rows) {
  edges.fill(0);
  split.fill(0);
  for (int z = 0; z < brick_side; ++z) {
    for (int y = 0; y < brick_side; ++y) {
      // The cells at (x, y, z), and those one below it along x, y or z, for all x.
      const auto at = [&](int dx, int dy, int dz) {
        return static_cast<unsigned>(rows[z + 1 - dz][y + 1 - dy]) >> (1 - dx) & 0xff;
      };
      cells[z][y] = static_cast<uint8_t>(at(0, 0, 0));
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3i b{axis == 2, axis == 0, axis == 1}, c{axis == 1, axis == 2, axis == 0};
        const unsigned above = at(0, 0, 0), below = at(b.x + c.x, b.y + c.y, b.z + c.z);
        const unsigned below_b = at(b.x, b.y, b.z), below_c = at(c.x, c.y, c.z);
        const unsigned diagonal = (above & below & ~below_b & ~below_c) | (below_b & below_c & ~above & ~below);
        edges[3 * z + axis] |= static_cast<uint64_t>(above | below | below_b | below_c) << brick_side * y;
        split[3 * z + axis] |= static_cast<uint64_t>(diagonal) << brick_side * y;
      }
    }
  }
}

}  // namespace soapfilm
