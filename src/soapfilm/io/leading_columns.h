// Whether a table of numbers without names begins with x y z, or with what numbers its rows.
#pragma once

#include "soapfilm/io/unnamed_columns.h"

namespace soapfilm::io {

/// What stands before x y z. Positions that are taken for something else are the worst misreading, so x y z is first
/// unless whole numbers that count the rows, or the cells of a grid, stand before three others that are not whole.
enum class LeadingColumns {
  none,
  unclear,        ///< x y z is first, but the first column is whole or rises, as numbers of points and times do
  unclear_cells,  ///< x y z is first, but the first two go through the cells of a grid
  number,
  row_column,
  column_row
};

LeadingColumns judge_leading(const PointCloud& cloud, const UnnamedColumns& unnamed);

}  // namespace soapfilm::io
