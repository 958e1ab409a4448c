// Samples that fill a range image, and those that name their cell.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm::io {

/// A grid with a sample in each cell: row after row, or column after column.
RangeGrid full_grid(int columns, int rows, bool by_columns = false);

/// Do columns of these names say in which row and column of a range grid each sample is?
bool name_cells(const std::vector<std::string>& names);

/// Once what it has lost is dropped: gives the cloud's only scan a range grid if it has columns of the names `row` and
/// `column` (or `col`, `v` and `u`, ...), and the origin as the scanner's place if the grid was seen from there.
/// Returns why there is no grid though there should be, for a warning; else nothing.
std::string give_named_grid(PointCloud& cloud);

}  // namespace soapfilm::io
