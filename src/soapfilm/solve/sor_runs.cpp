#include "soapfilm/solve/sor_runs.h"

#include <algorithm>
#include <numeric>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

RunKinds::RunKinds(const DenseField<float>& u, bool skip_empty, const Context& context)
    : runs_((u.size().x + sor_run - 1) / sor_run), rows_(u.size().y), layers_(u.size().z) {
  if (!skip_empty) return;
  beyond_.assign(static_cast<size_t>(runs_), RunKind::zero);
  kinds_.resize(offset(0, u.size().z));
  parallel_for(context, static_cast<size_t>(u.size().z), 1, [&](size_t layer) {
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
  for (size_t r = 1; r < runs; ++r) active[r] |= static_cast<uint8_t>(own[r] != own[r - 1]);
  for (size_t r = 1; r < runs; ++r) active[r - 1] |= static_cast<uint8_t>(own[r] != own[r - 1]);
}

DataRows::DataRows(const DenseField<float>& u, const SupportField& support, double scale)
    : size_(u.size()), row_begin_(static_cast<size_t>(u.size().y) * static_cast<size_t>(u.size().z) + 1) {
  // Two loops over the support: count the pieces of each row, then store them.
  const auto for_each_piece = [&](auto&& visit) {
    for (size_t b = 0; b < support.grid.size(); ++b) {
      const Vec3i first = support.grid.first_vertex(b) - u.origin();
      for (int z = first.z; z < first.z + brick_side; ++z)
        for (int y = first.y; y < first.y + brick_side; ++y) {
          if (y < 0 || y >= size_.y || z < 0 || z >= size_.z) continue;
          const float* f = support.f.brick(b) + brick_offset(0, y - first.y, z - first.z);
          Piece piece{first.x, {}};
          for (int i = std::max(0, -piece.x); i < std::min(brick_side, size_.x - piece.x); ++i)
            piece.f[i] = static_cast<float>(scale * f[i]);
          if (std::any_of(piece.f, piece.f + brick_side, [](float v) { return v != 0; })) visit(row_index(y, z), piece);
        }
    }
  };
  for_each_piece([&](size_t row, const Piece&) { ++row_begin_[row + 1]; });
  std::partial_sum(row_begin_.begin(), row_begin_.end(), row_begin_.begin());
  pieces_.resize(row_begin_.back());
  std::vector<size_t> next(row_begin_.begin(), row_begin_.end() - 1);
  for_each_piece([&](size_t row, const Piece& piece) { pieces_[next[row]++] = piece; });
}

bool DataRows::spread(int y, int z, float* out, uint8_t* active) const {
  const size_t row = row_index(y, z), begin = row_begin_[row], end = row_begin_[row + 1];
  if (begin == end) return false;
  std::fill_n(out, size_.x, 0.0f);
  for (size_t k = begin; k < end; ++k) {
    const Piece& piece = pieces_[k];
    std::copy_n(piece.f, brick_side, out + piece.x);
    active[std::max(piece.x, 0) / sor_run] = 1;
    active[std::min(piece.x + brick_side - 1, size_.x - 1) / sor_run] = 1;
  }
  return true;
}

double DataRows::product(int y, int z, const float* u) const {
  const size_t row = row_index(y, z);
  double sums[brick_side] = {};  // several, so that one does not wait for the other
  for (size_t k = row_begin_[row]; k < row_begin_[row + 1]; ++k) {
    const Piece& piece = pieces_[k];
    for (int i = 0; i < brick_side; ++i)
      sums[i] += static_cast<double>(piece.f[i]) * static_cast<double>(u[piece.x + i]);
  }
  return std::accumulate(std::begin(sums), std::end(sums), 0.0);
}

}  // namespace soapfilm
