// Samples that fill a range image, and those that name their cell.
#pragma once

#include <string>

#include "soapfilm/cloud.h"

namespace soapfilm::io {

/// A grid with a sample in each cell: row after row, or column after column.
RangeGrid full_grid(int columns, int rows, bool by_columns = false);

/// Drops samples whose coordinates are all not-a-number: rays that met nothing. Returns how many there were.
size_t drop_empty_cells(PointCloud& cloud);

/// After finish_points(): gives the cloud's only scan a range grid if it has columns of the names `row` and `column`
/// (or `col`, `v` and `u`, ...), and the origin as the scanner's place if the grid was seen from there. Returns why
/// there is no grid though there should be, for a warning; else nothing.
std::string give_named_grid(PointCloud& cloud);

}  // namespace soapfilm::io
