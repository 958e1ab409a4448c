// Two views of a whole-box array, row by row in runs of 8 values: which runs can change at all (the paper's bitmap of
// empty cubes), and the data term as dense rows.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/kernels/sor_kernel.h"

namespace soapfilm {

/// The kind of every run of every row: one byte for 8 values.
class RunKinds {
 public:
  /// If `skip_empty` is false every run counts as mixed and nothing is stored.
  RunKinds(const DenseField<float>& u, bool skip_empty, const Context& context);

  int runs() const { return runs_; }
  /// Null if nothing is stored.
  RunKind* row(int y, int z) { return kinds_.empty() ? nullptr : kinds_.data() + offset(y, z); }
  size_t bytes() const { return kinds_.size() * sizeof(RunKind); }

  /// Sets active[r] where a run, or one of the six around it, is not the same constant. Beyond the box u is 0.
  void mark(int y, int z, uint8_t* active) const;

 private:
  size_t offset(int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(rows_) + static_cast<size_t>(y)) * static_cast<size_t>(runs_);
  }

  int runs_, rows_, layers_;
  std::vector<RunKind> kinds_;
  std::vector<RunKind> beyond_;  ///< a row of zero runs
};

/// The data term in the row order of a whole-box array: pieces of 8 values; pieces without data are not stored.
class DataRows {
 public:
  /// Stores scale times f.
  DataRows(const DenseField<float>& u, const SupportField& support, double scale);

  /// Fills out[0 .. size) and marks the runs with data; if the row has none does nothing and returns false. There must
  /// be room for 8 values before and after: pieces may extend beyond the row (with zeros).
  bool spread(int y, int z, float* out, uint8_t* active) const;
  /// <scale f, u> over the row.
  double product(int y, int z, const float* u) const;
  size_t bytes() const { return pieces_.size() * sizeof(Piece) + row_begin_.size() * sizeof(size_t); }

 private:
  struct Piece {
    int x;
    float f[brick_side];
  };
  size_t row_index(int y, int z) const {
    return static_cast<size_t>(z) * static_cast<size_t>(size_.y) + static_cast<size_t>(y);
  }

  Vec3i size_;
  std::vector<size_t> row_begin_;  ///< first piece of each row; one more at the end
  std::vector<Piece> pieces_;
};

}  // namespace soapfilm
