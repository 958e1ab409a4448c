#include "soapfilm/io/cell_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace soapfilm::io {

void CellGrid::add(double row, double column, double order) {
  const auto fits = [](double index) { return index >= INT32_MIN && index <= INT32_MAX && index == std::floor(index); };
  const bool fit = fits(row) && fits(column);
  valid_ = valid_ && fit;
  cells_.push_back(
      {fit ? static_cast<int32_t>(row) : 0, fit ? static_cast<int32_t>(column) : 0, static_cast<float>(order)});
}

void CellGrid::filter(const std::vector<bool>& keep) {
  size_t kept = 0;
  for (size_t i = 0; i < cells_.size(); ++i)
    if (keep[i]) cells_[kept++] = cells_[i];
  cells_.resize(kept);
}

std::string CellGrid::give_to(Scan& scan) const {
  constexpr int64_t cells_per_sample = 4, few_cells = 256;
  if (cells_.empty()) return {};
  if (!valid_) return "rows or columns are not whole numbers of 32 bits";
  int64_t low_row = INT32_MAX, high_row = INT32_MIN, low_column = INT32_MAX, high_column = INT32_MIN;
  for (const Cell& cell : cells_) {
    low_row = std::min<int64_t>(low_row, cell.row), high_row = std::max<int64_t>(high_row, cell.row);
    low_column = std::min<int64_t>(low_column, cell.column), high_column = std::max<int64_t>(high_column, cell.column);
  }
  const int64_t rows = high_row - low_row + 1, columns = high_column - low_column + 1;
  if (rows < 2 || columns < 2) return {};
  const int64_t most = std::min<int64_t>(cells_per_sample * static_cast<int64_t>(cells_.size()) + few_cells, INT32_MAX);
  if (rows > most / columns)
    return fmt::format("{} rows and {} columns, must be at most {} cells for {} samples", rows, columns, most,
                       cells_.size());
  RangeGrid grid{static_cast<int>(columns), static_cast<int>(rows), {}};
  grid.sample.assign(static_cast<size_t>(rows * columns), -1);
  for (size_t i = 0; i < cells_.size(); ++i) {
    const Cell& cell = cells_[i];
    int32_t& sample = grid.sample[static_cast<size_t>((cell.row - low_row) * columns + (cell.column - low_column))];
    if (sample >= 0) {
      const float before = cells_[static_cast<size_t>(sample)].order;
      if (!(cell.order < before || cell.order > before))
        return fmt::format("several samples in row {}, column {}, must be one", cell.row, cell.column);
      if (cell.order > before) continue;
    }
    sample = static_cast<int32_t>(i);
  }
  scan.range_grid = std::move(grid);
  return {};
}

}  // namespace soapfilm::io
