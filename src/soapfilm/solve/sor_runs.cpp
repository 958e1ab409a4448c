#include "soapfilm/solve/sor_runs.h"

#include <algorithm>

namespace soapfilm {

RunKinds::RunKinds(const DenseField<float>& u, bool skip_empty, const Parallel& parallel)
    : runs_((u.size().x + sor_run - 1) / sor_run), rows_(u.size().y), layers_(u.size().z) {
  if (!skip_empty) return;
  beyond_.assign(static_cast<size_t>(runs_), RunKind::zero);
  kinds_.resize(offset(0, u.size().z));
  parallel.for_each(static_cast<size_t>(u.size().z), 1, [&](size_t layer) {
    const int z = static_cast<int>(layer);
    for (int y = 0; y < rows_; ++y) {
      const float* values = u.row(y, z);
      for (int r = 0; r < runs_; ++r) {
        const int x = r * sor_run;
        kinds_[offset(y, z) + static_cast<size_t>(r)] = run_kind(values + x, std::min(sor_run, u.size().x - x));
      }
    }
  });
}

void RunKinds::mark(int y, int z, uint8_t* active) const {
  const size_t runs = static_cast<size_t>(runs_);
  if (kinds_.empty()) return std::fill_n(active, runs, uint8_t{1}), void();
  const auto row_at = [&](int j, int k) {
    const bool within = j >= 0 && j < rows_ && k >= 0 && k < layers_;
    return within ? kinds_.data() + offset(j, k) : beyond_.data();
  };
  const RunKind* own = row_at(y, z);
  const RunKind *back = row_at(y - 1, z), *front = row_at(y + 1, z);
  const RunKind *below = row_at(y, z - 1), *above = row_at(y, z + 1);
  for (size_t r = 0; r < runs; ++r)
    active[r] |= static_cast<uint8_t>((own[r] == RunKind::mixed) | (back[r] != own[r]) | (front[r] != own[r]) |
                                      (below[r] != own[r]) | (above[r] != own[r]));
  for (size_t r = 1; r < runs; ++r) {
    const auto differ = static_cast<uint8_t>(own[r] != own[r - 1]);
    active[r - 1] |= differ;
    active[r] |= differ;
  }
}

DataRows::DataRows(const DenseField<float>& u, const LevelBox& box, const SupportField& support)
    : support_(support), origin_(u.origin()), size_(u.size()), bricks_(box.bricks) {
  row_begin_.resize(static_cast<size_t>(bricks_.y) * static_cast<size_t>(bricks_.z) + 1);
  size_t row = 0;
  for (size_t b = 0; b <= support.grid.size(); ++b) {
    const Vec3i c = b < support.grid.size() ? support.grid.coord(b) : Vec3i{0, 0, bricks_.z};
    for (const size_t next = static_cast<size_t>(c.z * bricks_.y + c.y); row <= next && row < row_begin_.size(); ++row)
      row_begin_[row] = static_cast<int32_t>(b);
  }
}

template <class Visit>
bool DataRows::for_each_piece(int y, int z, Visit&& visit) const {
  const Vec3i vertex = origin_ + Vec3i{0, y, z};
  const Vec3i brick = brick_of(vertex);
  const size_t row = static_cast<size_t>(brick.z * bricks_.y + brick.y);
  if (brick.y >= bricks_.y || brick.z >= bricks_.z) return false;
  bool any = false;
  for (int32_t b = row_begin_[row]; b < row_begin_[row + 1]; ++b) {
    const int first = support_.grid.coord(static_cast<size_t>(b)).x * brick_side - origin_.x;
    const int begin = std::max(first, 0), end = std::min(first + brick_side, size_.x);
    if (begin >= end) continue;
    const float* f = support_.f.brick(static_cast<size_t>(b)) + brick_offset(begin - first, vertex.y & 7, vertex.z & 7);
    visit(begin, f, end - begin);
    any = true;
  }
  return any;
}

bool DataRows::spread(int y, int z, float scale, float* out, uint8_t* active) const {
  bool cleared = false;
  return for_each_piece(y, z, [&](int x, const float* f, int count) {
    if (!cleared) std::fill_n(out, size_.x, 0.0f);
    cleared = true;
    for (int i = 0; i < count; ++i) out[x + i] = scale * f[i];
    active[x / sor_run] = active[(x + count - 1) / sor_run] = 1;
  });
}

double DataRows::product(int y, int z, const float* u) const {
  double sum = 0;
  for_each_piece(y, z, [&](int x, const float* f, int count) {
    for (int i = 0; i < count; ++i) sum += static_cast<double>(f[i]) * static_cast<double>(u[x + i]);
  });
  return sum;
}

}  // namespace soapfilm
