// Which cells an extraction draws: all for a closed surface, those with known corners for an open one. Internal.
#pragma once

#include <array>
#include <cstdint>

#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"

namespace soapfilm {

/// One bit for each edge whose lower vertex lies in a brick: word 3 z + axis, bit x + 8 y.
using BrickEdges = std::array<uint64_t, 3 * brick_side>;

/// The drawn ones of the cells and edges whose lower vertex lies in one brick.
struct DrawnCells {
  std::array<std::array<uint8_t, brick_side>, brick_side> cells;  ///< [z][y], bit x
  BrickEdges edges;                                               ///< that touch a drawn cell
  /// Edges whose drawn cells are two that share no face. One surface point there would join two sheets that have
  /// nothing else in common, so each gets its own; the cell above the edge along takes_second_axis() uses the second
  /// one.
  BrickEdges split;

  /// Draws all of them.
  DrawnCells();
  /// Draws cells whose eight corners are known: `weight` > 0 there. Bricks that are not in the grid are unknown.
  /// `brick` need not be in the grid.
  DrawnCells(const BrickGrid& grid, const Field<float>& weight, Vec3i brick);
  /// Draws cells whose corners are vertices lo to hi of the lattice, both included.
  DrawnCells(Vec3i lo, Vec3i hi, Vec3i brick);

 private:
  /// Rows of bits along x, from -1 on; [z + 1][y + 1]: of the cells around the brick's edges.
  using CellRows = std::array<std::array<uint16_t, brick_side + 1>, brick_side + 1>;
  void draw(const CellRows& rows);
};

/// The two cells of a split edge lie on different sides of it along both other axes; this one distinguishes them.
constexpr int takes_second_axis(int edge_axis) { return (edge_axis + 2) % 3; }

}  // namespace soapfilm
