#include "soapfilm/simplify/thin_places.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/half_spaces.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

struct Bounds {
  Vec3d lo, hi;
  explicit Bounds(const std::array<Vec3d, 3>& t) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min({t[0][k], t[1][k], t[2][k]});
      hi[k] = std::max({t[0][k], t[1][k], t[2][k]});
    }
  }
  bool apart(const Bounds& o) const {
    return lo.x > o.hi.x || hi.x < o.lo.x || lo.y > o.hi.y || hi.y < o.lo.y || lo.z > o.hi.z || hi.z < o.lo.z;
  }
};

LatticeTriangle lattice_of(const EditedMesh& now, const std::array<Vec3d, 3>& t) {
  return now.written.lattice(t[0], t[1], t[2]);
}

}  // namespace

ThinPlaces::ThinPlaces(const EditedMesh& now, double distance) : now_(now) {
  CellTable all;
  std::vector<uint32_t> facing;
  std::vector<Vec3i> cells;
  for (const Triangle& f : now.was.all_corners()) {
    const Vec3d a = now.original[f[0]], b = now.original[f[1]], c = now.original[f[2]];
    const uint32_t own = faced_half_spaces(cross(b - a, c - a));
    for_cells(a, b, c, distance, per_side, [&](Vec3i cell) {
      const uint32_t number = all.insert(cell_key(cell));
      if (number == cells.size()) {
        cells.push_back(cell);
        facing.push_back(all_half_spaces);
      }
      facing[number] &= own;
    });
  }
  for (size_t i = 0; i < cells.size(); ++i) {
    if (facing[i] != 0) continue;
    thin_.insert(cell_key(cells[i]));
    coarse_.insert(cell_key({cells[i].x >> coarse, cells[i].y >> coarse, cells[i].z >> coarse}));
  }
  lists_.resize(thin_.size());
  if (lists_.empty()) return;
  for (uint32_t t = 0; t < now.mesh.triangles(); ++t)
    if (now.mesh.is_alive(t)) insert(t);
}

bool ThinPlaces::near(const Box3d& box) const {
  if (lists_.empty()) return false;
  const Vec3i lo = cell_of(box.lo, per_side), hi = cell_of(box.hi, per_side);
  for (int z = lo.z >> coarse; z <= hi.z >> coarse; ++z)
    for (int y = lo.y >> coarse; y <= hi.y >> coarse; ++y)
      for (int x = lo.x >> coarse; x <= hi.x >> coarse; ++x)
        if (coarse_.find(cell_key({x, y, z})) != CellTable::none) return true;
  return false;
}

template <class Visit>
void ThinPlaces::for_lists(Vec3d a, Vec3d b, Vec3d c, Visit&& visit) const {
  for_cells(a, b, c, 0, std::ldexp(per_side, finer_), [&](Vec3i cell) {
    const CellTable& cells = finer_ == 0 ? thin_ : fine_;
    if (const uint32_t list = cells.find(cell_key(cell)); list != CellTable::none) visit(list);
  });
}

bool ThinPlaces::meets(std::span<const NewTriangle> triangles, std::span<const uint32_t> replaced) const {
  std::vector<LatticeTriangle> exact;
  for (const NewTriangle& t : triangles) exact.push_back(lattice_of(now_, t.corner));
  for (size_t i = 0; i < exact.size(); ++i) {
    if (is_flat(exact[i])) return true;
    for (size_t j = 0; j < i; ++j)
      if (improperly_meet(exact[i], exact[j])) return true;
  }
  std::vector<uint32_t> seen;
  for (size_t i = 0; i < exact.size(); ++i) {
    const Bounds own(triangles[i].corner);
    seen.assign(replaced.begin(), replaced.end());
    bool met = false;
    for_lists(triangles[i].corner[0], triangles[i].corner[1], triangles[i].corner[2], [&](uint32_t list) {
      for (const uint32_t u : lists_[list]) {
        if (met) return;
        const auto other = now_.corners(u);
        if (own.apart(Bounds(other)) || std::find(seen.begin(), seen.end(), u) != seen.end()) continue;
        seen.push_back(u);
        const LatticeTriangle there = lattice_of(now_, other);
        met = !is_flat(there) && improperly_meet(exact[i], there);
      }
    });
    if (met) return true;
  }
  return false;
}

void ThinPlaces::remove(uint32_t triangle) {
  for_lists(now_.corner(triangle, 0), now_.corner(triangle, 1), now_.corner(triangle, 2), [&](uint32_t list) {
    std::vector<uint32_t>& there = lists_[list];
    if (const auto at = std::find(there.begin(), there.end(), triangle); at != there.end()) {
      *at = there.back();
      there.pop_back();
    }
  });
}

void ThinPlaces::insert(uint32_t triangle) {
  const auto [a, b, c] = now_.corners(triangle);
  if (finer_ == 0) return for_lists(a, b, c, [&](uint32_t list) { lists_[list].push_back(triangle); });
  for_cells(a, b, c, 0, std::ldexp(per_side, finer_), [&](Vec3i cell) {
    if (thin_.find(cell_key({cell.x >> finer_, cell.y >> finer_, cell.z >> finer_})) == CellTable::none) return;
    const uint32_t list = fine_.insert(cell_key(cell));
    if (list == lists_.size()) lists_.emplace_back();
    lists_[list].push_back(triangle);
  });
}

void ThinPlaces::refile(double side_of_cells) {
  // Cells of triangles that are much smaller have numbers of too many bits.
  constexpr int finest = 4;
  const int finer = std::clamp(static_cast<int>(std::floor(std::log2(side / side_of_cells))), 0, finest);
  if (lists_.empty() || finer == finer_) return;
  finer_ = finer;
  fine_ = {};
  lists_.assign(finer == 0 ? thin_.size() : 0, {});
  for (uint32_t t = 0; t < now_.mesh.triangles(); ++t)
    if (now_.mesh.is_alive(t)) insert(t);
}

std::vector<std::array<uint32_t, 2>> meeting_pairs(const EditedMesh& now, const std::vector<uint8_t>& marked,
                                                   const Context& context) {
  constexpr double per_side = 0.5;
  constexpr size_t cells_per_task = 256;
  using Pair = std::array<uint32_t, 2>;
  const auto for_all = [&](auto&& visit) {
    for (uint32_t t = 0; t < now.mesh.triangles(); ++t)
      if (now.mesh.is_alive(t))
        for_cells(now.corner(t, 0), now.corner(t, 1), now.corner(t, 2), 0, per_side,
                  [&](Vec3i cell) { visit(t, cell_key(cell)); });
  };
  // Only cells with a marked triangle are searched.
  CellTable cells;
  for (uint32_t t = 0; t < now.mesh.triangles(); ++t)
    if (marked[t] && now.mesh.is_alive(t))
      for_cells(now.corner(t, 0), now.corner(t, 1), now.corner(t, 2), 0, per_side,
                [&](Vec3i cell) { cells.insert(cell_key(cell)); });
  std::vector<size_t> begin(cells.size() + 1);
  for_all([&](uint32_t, uint64_t key) {
    if (const uint32_t cell = cells.find(key); cell != CellTable::none) ++begin[cell + 1];
  });
  for (size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<uint32_t> there(begin.back());
  std::vector<size_t> next(begin.begin(), begin.end() - 1);
  for_all([&](uint32_t t, uint64_t key) {
    if (const uint32_t cell = cells.find(key); cell != CellTable::none) there[next[cell]++] = t;
  });

  auto pairs = gather<Pair>(cells.size(), cells_per_task, context, [&](size_t cell, std::vector<Pair>& found) {
    struct Item {
      uint32_t triangle;
      Bounds bounds;
      LatticeTriangle exact;
    };
    std::vector<Item> items;
    for (size_t i = begin[cell]; i < begin[cell + 1]; ++i) {
      const auto corners = now.corners(there[i]);
      const LatticeTriangle exact = lattice_of(now, corners);
      if (is_flat(exact)) {
        if (marked[there[i]]) found.push_back({there[i], there[i]});
      } else {
        items.push_back({there[i], Bounds(corners), exact});
      }
    }
    for (size_t i = 0; i < items.size(); ++i)
      for (size_t j = i + 1; j < items.size(); ++j) {
        const Item &a = items[i], &b = items[j];
        if ((marked[a.triangle] || marked[b.triangle]) && !a.bounds.apart(b.bounds) &&
            improperly_meet(a.exact, b.exact))
          found.push_back({a.triangle, b.triangle});
      }
  });
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace soapfilm
