// Range grids of scans whose samples say in which row and column they lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm::io {

/// The cell of each sample of a scan.
class CellGrid {
 public:
  void reserve(size_t count) { cells_.reserve(count); }
  /// `order`: of several samples in a cell the one with the lowest takes it. Of rows and columns that are not whole
  /// numbers of 32 bits there will be no grid.
  void add(double row, double column, double order);
  /// Keeps the samples where keep[i] is true.
  void filter(const std::vector<bool>& keep);

  /// Fills in the grid of a scan that holds the added samples in order; its first row and column are the lowest ones
  /// that have a sample. Without two rows and columns there is none, as no sample has neighbors. Returns why there is
  /// none though there should be, for a warning; else nothing.
  std::string give_to(Scan& scan) const;

 private:
  struct Cell {
    int32_t row, column;
    float order;
  };
  std::vector<Cell> cells_;
  bool valid_ = true;
};

}  // namespace soapfilm::io
