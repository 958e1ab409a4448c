#include "soapfilm/grid/brick_grid.h"

#include "soapfilm/core/indices.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

BrickGrid::BrickGrid(const BrickMask& active, const Context& context) : bricks_(active.bricks()) {
  require_indices(active.count(), most_bricks, "bricks of the grid");
  coords_.reserve(active.count());
  active.for_each([&](Vec3i b) { coords_.push_back(b); });
  find_rows();
  index_words();
  find_neighbors(context);
}

void BrickGrid::find_rows() {
  for (size_t b = 0; b < coords_.size(); ++b) {
    const Vec3i c = coords_[b];
    if (slices_.empty() || slices_.back().z != c.z) slices_.push_back({c.z, rows_.size(), rows_.size(), b, b});
    Slice& slice = slices_.back();
    if (slice.first_row == slice.end_row || rows_.back().y != c.y) {
      rows_.push_back({c.y, b, b});
      ++slice.end_row;
    }
    slice.end = rows_.back().end = b + 1;
  }
}

void BrickGrid::index_words() {
  size_t words = 0;
  for (size_t b = 0; b < coords_.size(); ++b) words += b == 0 || !(word_of(coords_[b]) == word_of(coords_[b - 1]));
  words_.reserve(words);
  for (size_t s = 0; s < slices_.size(); ++s)
    for (size_t r = slices_[s].first_row; r < slices_[s].end_row; ++r)
      for (size_t b = rows_[r].begin; b < rows_[r].end; ++b) {
        Word& word = words_[word_of(coords_[b])];
        if (word.bits == 0) {
          word.before = static_cast<int32_t>(b);
          word.gaps_before = static_cast<uint32_t>(2 * (s + 1) + 2 * r);
        }
        word.bits |= uint64_t{1} << bit_in_word(coords_[b]);
      }
}

void BrickGrid::find_neighbors(const Context& context) {
  neighbors_.resize(coords_.size());
  parallel_for(context, coords_.size(), 1024, [&](size_t i) {
    const Vec3i own = coords_[i];
    const int bit = bit_in_word(own);
    const bool within = bit > 0 && bit < (1 << word_bits) - 1 && own.x > 0 && own.x < bricks_.x - 1;
    for (int row = 0; row < 9; ++row) {
      const Vec3i below = own + slot_offset(3 * row);
      int32_t* out = &neighbors_[i][static_cast<size_t>(3 * row)];
      const Vec3i middle = below + Vec3i{1, 0, 0};
      if (!within || !BrickRange::whole(bricks_).contains(middle)) {
        for (int x = 0; x < 3; ++x) out[x] = find(below + Vec3i{x, 0, 0});
        continue;
      }
      const Word* word = words_.find(word_of(middle));
      for (int x = 0; x < 3; ++x) {
        const Vec3i b = below + Vec3i{x, 0, 0};
        out[x] = word && (word->bits >> bit_in_word(b) & 1) ? word->rank(b) : outside_band;
      }
    }
  });
}

// Gaps in their order: one before each slice; in a slice one before each row, and one at its end; in a row one before
// each brick, and one at its end; at last one after all slices.
size_t BrickGrid::gap(Vec3i b) const {
  if (const Word* word = words_.find(word_of(b))) return word->gaps_before + static_cast<size_t>(word->rank(b));
  const size_t s = slice_from(b.z);
  if (s == slices_.size() || slices_[s].z != b.z)
    return s == slices_.size() ? gaps() - 1 : 2 * s + 2 * slices_[s].first_row + slices_[s].begin;
  const size_t r = row_from(slices_[s], b.y);
  const size_t begin = r < slices_[s].end_row ? rows_[r].begin : slices_[s].end;
  if (r == slices_[s].end_row || rows_[r].y != b.y) return 2 * s + 1 + 2 * r + begin;
  const auto first = coords_.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto end = coords_.begin() + static_cast<std::ptrdiff_t>(rows_[r].end);
  const auto next = std::partition_point(first, end, [&](Vec3i c) { return c.x < b.x; });
  return 2 * (s + 1) + 2 * r + static_cast<size_t>(next - coords_.begin());
}

void add_bricks(const BrickGrid& grid, BrickMask& mask) {
  for (size_t b = 0; b < grid.size(); ++b) mask.set(grid.coord(b));
}

BrickMask parents_of(const BrickGrid& children, Vec3i bricks, const Context& context) {
  BrickMask parents(bricks);
  parallel_for(context, children.size(), 256, [&](size_t b) { parents.set_shared(parent_of(children.coord(b))); });
  return parents;
}

BrickMask with_neighbors(const BrickMask& bricks) {
  BrickMask more(bricks.bricks());
  bricks.for_each([&](Vec3i b) {
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i next = b + slot_offset(slot); more.contains(next)) more.set(next);
  });
  return more;
}

}  // namespace soapfilm
