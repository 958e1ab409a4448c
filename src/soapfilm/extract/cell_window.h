// The vertices of the cells of one block of the grid, for the extraction of an isosurface.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "soapfilm/core/vec.h"
#include "soapfilm/extract/drawn_cells.h"
#include "soapfilm/grid/layout.h"

namespace soapfilm {

/// An inside bit for each of the 9^3 vertices of a block's cells and, where there is a surface, the values.
struct CellWindow {
  static constexpr int side = brick_side + 1;  // vertices along an axis

  std::array<float, side * side * side> values;
  std::array<std::array<uint16_t, side>, side> inside;  // [z][y], bit x

  DrawnCells drawn;

  static int offset(int x, int y, int z) { return x + side * (y + side * z); }
  static bool holds(Vec3i v) {
    const auto within = [](int i) { return i >= 0 && i < side; };
    return within(v.x) && within(v.y) && within(v.z);
  }
  float value(Vec3i v) const { return values[static_cast<size_t>(offset(v.x, v.y, v.z))]; }

  /// Whether there are vertices both inside and outside.
  bool has_both_sides() const {
    constexpr uint16_t whole = (1 << side) - 1;
    uint16_t any = 0, all = whole;
    for (const auto& layer : inside)
      for (const uint16_t bits : layer) {
        any = static_cast<uint16_t>(any | bits);
        all = static_cast<uint16_t>(all & bits);
      }
    return any != 0 && all != whole;
  }

  /// Case of marching cubes, for a cell.
  int case_of(int x, int y, int z) const {
    const auto pair = [&](int dy, int dz) { return inside[z + dz][y + dy] >> x & 3; };
    return pair(0, 0) | pair(1, 0) << 2 | pair(0, 1) << 4 | pair(1, 1) << 6;
  }

  /// visit(x, y, z) for the drawn cells that the surface cuts.
  template <class Visit>
  void for_each_cut_cell(Visit&& visit) const {
    for (int z = 0; z < brick_side; ++z) {
      for (int y = 0; y < brick_side; ++y) {
        const uint16_t rows[] = {inside[z][y], inside[z][y + 1], inside[z + 1][y], inside[z + 1][y + 1]};
        const int any = rows[0] | rows[1] | rows[2] | rows[3];
        const int all = rows[0] & rows[1] & rows[2] & rows[3];
        // A cell is cut unless its eight corners agree.
        unsigned cut = ((any | any >> 1) & ~(all & all >> 1)) & drawn.cells[z][y];
        for (; cut != 0; cut &= cut - 1) visit(std::countr_zero(cut), y, z);
      }
    }
  }
};

}  // namespace soapfilm
