// Two views of a whole-box array row by row, in runs of 8 values: which runs can change at all (the paper's bitmap of
// empty cubes), and the sparse data term spread out.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/solve/sor_kernel.h"

namespace soapfilm {

/// The kind of every run of every row: one byte for 8 values.
class RunKinds {
 public:
  /// With `skip_empty` false every run counts as mixed and nothing is kept.
  RunKinds(const DenseField<float>& u, bool skip_empty, const Parallel& parallel);

  int runs() const { return runs_; }
  /// Null when nothing is kept.
  RunKind* row(int y, int z) { return kinds_.empty() ? nullptr : kinds_.data() + offset(y, z); }
  size_t bytes() const { return kinds_.size() * sizeof(RunKind); }

  /// Sets active[r] where a run, or one of the six around it, is not the same constant. Beyond the box lies 0.
  void mark(int y, int z, uint8_t* active) const;

 private:
  size_t offset(int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(rows_) + static_cast<size_t>(y)) * static_cast<size_t>(runs_);
  }

  int runs_, rows_, layers_;
  std::vector<RunKind> kinds_;
  std::vector<RunKind> beyond_;  ///< a row of zero runs
};

/// The data term f of the support bricks along the rows of a whole-box array.
class DataRows {
 public:
  DataRows(const DenseField<float>& u, const LevelBox& box, const SupportField& support);

  /// out[x] = scale f(x, y, z), 0 where there is no support; `out` holds a whole row. Sets active[x / 8] where bricks
  /// of the support lie. Returns false, with nothing written, where the row meets none.
  bool spread(int y, int z, float scale, float* out, uint8_t* active) const;
  /// <f, u> over the row.
  double product(int y, int z, const float* u) const;
  size_t bytes() const { return support_.f.bytes() + support_.grid.bytes() + row_begin_.size() * sizeof(int32_t); }

 private:
  /// visit(x, f, count) for each piece of the row that a brick covers.
  template <class Visit>
  bool for_each_piece(int y, int z, Visit&& visit) const;

  const SupportField& support_;
  Vec3i origin_, size_, bricks_;
  std::vector<int32_t> row_begin_;  ///< first brick of brick row (y, z); one more at the end
};

}  // namespace soapfilm
