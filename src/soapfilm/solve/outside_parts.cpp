#include "soapfilm/solve/outside_parts.h"

#include <algorithm>
#include <utility>

namespace soapfilm {

OutsideParts::OutsideParts(const VertexMask& band, const LevelBox& box, const std::vector<Link>& links)
    : band_(band),
      box_(box),
      links_(links),
      lo_(box.free_lo - Vec3i{1, 1, 1}),
      size_(box.free_hi - box.free_lo + Vec3i{3, 3, 3}) {
  row_begin_.reserve(static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z) + 1);
  for (int z = lo_.z; z < lo_.z + size_.z; ++z)
    for (int y = lo_.y; y < lo_.y + size_.y; ++y) {
      row_begin_.push_back(static_cast<uint32_t>(runs_.size()));
      for (int x = lo_.x, end = lo_.x + size_.x; x < end; ++x) {
        if (band.test({x, y, z})) continue;
        const int first = x;
        while (x + 1 < end && !band.test({x + 1, y, z})) ++x;
        runs_.push_back({first, x, static_cast<uint32_t>(runs_.size())});
      }
    }
  row_begin_.push_back(static_cast<uint32_t>(runs_.size()));

  // Rows that a link joins: without the steps along x, and how far the link reaches along x.
  for (const Link& link : links) {
    const Vec3i s = link.step;
    if (s.z > 0 || (s.z == 0 && s.y >= 0)) continue;
    for (int z = lo_.z; z < lo_.z + size_.z; ++z)
      for (int y = lo_.y; y < lo_.y + size_.y; ++y) {
        const int other_y = y + s.y, other_z = z + s.z;
        if (other_y < lo_.y || other_z < lo_.z || other_y >= lo_.y + size_.y) continue;
        join_rows(row_of(y, z), row_of(other_y, other_z), s.x);
      }
  }
}

size_t OutsideParts::row_of(int y, int z) const {
  return static_cast<size_t>(z - lo_.z) * static_cast<size_t>(size_.y) + static_cast<size_t>(y - lo_.y);
}

uint32_t OutsideParts::root(uint32_t run) {
  while (runs_[run].parent != run) run = runs_[run].parent = runs_[runs_[run].parent].parent;
  return run;
}

/// Joins the runs of two rows that touch after one is moved by `shift`.
void OutsideParts::join_rows(size_t row, size_t other, int shift) {
  uint32_t a = row_begin_[row], b = row_begin_[other];
  while (a < row_begin_[row + 1] && b < row_begin_[other + 1]) {
    const int first = runs_[a].first + shift, last = runs_[a].last + shift;
    if (first <= runs_[b].last && runs_[b].first <= last) {
      const uint32_t ra = root(a), rb = root(b);
      // The smaller root is kept, so the part of the fixed vertices has root 0.
      runs_[std::max(ra, rb)].parent = std::min(ra, rb);
    }
    last < runs_[b].last ? ++a : ++b;
  }
}

uint32_t OutsideParts::part_at(Vec3i v) {
  const size_t row = row_of(v.y, v.z);
  const auto begin = runs_.begin() + row_begin_[row], end = runs_.begin() + row_begin_[row + 1];
  const auto after = std::upper_bound(begin, end, v.x, [](int x, const Run& run) { return x < run.first; });
  return root(static_cast<uint32_t>(after - runs_.begin() - 1));
}

template <class Visit>
void OutsideParts::for_each_rim_link(Visit&& visit) {
  band_.for_each([&](Vec3i v) {
    for (const Link& link : links_)
      if (const Vec3i next = v + link.step; !band_.test(next) && box_.is_free(next)) visit(v, part_at(next));
  });
}

RimVotes OutsideParts::vote(const VertexMask& inside) {
  constexpr uint32_t border = 0;
  constexpr size_t border_itself = 1;
  count_.assign(runs_.size(), {});
  count_[border].outside = border_itself;
  for_each_rim_link([&](Vec3i v, uint32_t part) { ++(inside.test(v) ? count_[part].inside : count_[part].outside); });

  RimVotes votes{VertexMask(band_.bricks()), VertexMask(band_.bricks()), true};
  for_each_rim_link([&](Vec3i v, uint32_t part) {
    if (count_[part].agree()) return;
    votes.agree = false;
    (inside.test(v) ? votes.inside : votes.outside).set(v);
  });
  if (count_[border].agree() || count_[border].outside > border_itself) return votes;
  for (int z = box_.free_lo.z; z <= box_.free_hi.z; ++z)
    for (int y = box_.free_lo.y; y <= box_.free_hi.y; ++y) {
      const bool edge = z == box_.free_lo.z || z == box_.free_hi.z || y == box_.free_lo.y || y == box_.free_hi.y;
      const int step = edge ? 1 : std::max(1, box_.free_hi.x - box_.free_lo.x);
      for (int x = box_.free_lo.x; x <= box_.free_hi.x; x += step) votes.outside.set({x, y, z});
    }
  return votes;
}

void OutsideParts::fill(VertexMask& inside) const {
  for (size_t row = 0; row + 1 < row_begin_.size(); ++row)
    for (uint32_t r = row_begin_[row]; r < row_begin_[row + 1]; ++r) {
      uint32_t part = r;
      while (runs_[part].parent != part) part = runs_[part].parent;
      if (count_[part].inside == 0) continue;
      const int y = lo_.y + static_cast<int>(row % static_cast<size_t>(size_.y));
      const int z = lo_.z + static_cast<int>(row / static_cast<size_t>(size_.y));
      for (int x = runs_[r].first; x <= runs_[r].last; ++x) inside.set({x, y, z});
    }
}

}  // namespace soapfilm
