#include "soapfilm/extract/leaf_loops.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "soapfilm/extract/marching_cubes_table.h"

namespace soapfilm {

namespace {

constexpr double impossible = std::numeric_limits<double>::infinity();

bool on_one_face(const FaceEdges& faces, uint64_t a, uint64_t b) {
  return std::any_of(faces.begin(), faces.end(), [&](const auto& face) {
    const auto has = [&](uint64_t edge) { return std::find(face.begin(), face.end(), edge) != face.end(); };
    return has(a) && has(b);
  });
}

}  // namespace

bool triangulate_loop(const std::vector<LoopPoint>& loop, const FaceEdges& faces,
                      std::vector<std::array<int, 3>>& triangles) {
  constexpr int longest = marching_cubes::longest_loop;
  const int size = static_cast<int>(loop.size());
  double cost[longest][longest] = {};
  int apex[longest][longest] = {};
  for (int span = 2; span < size; ++span)
    for (int first = 0; first + span < size; ++first) {
      const int last = first + span;
      double best = impossible;
      for (int k = first + 1; k < last; ++k)
        if (const double sum = cost[first][k] + cost[k][last]; sum < best) {
          best = sum;
          apex[first][last] = k;
        }
      const bool is_side = first == 0 && last == size - 1;
      const LoopPoint &a = loop[static_cast<size_t>(first)], &b = loop[static_cast<size_t>(last)];
      const Vec3d diagonal = b.place - a.place;
      if (!is_side) best += on_one_face(faces, a.edge, b.edge) ? impossible : dot(diagonal, diagonal);
      cost[first][last] = best;
    }
  if (cost[0][size - 1] == impossible) return false;
  std::vector<std::pair<int, int>> open = {{0, size - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    if (last - first < 2) continue;
    const int k = apex[first][last];
    triangles.push_back({first, k, last});
    open.push_back({k, last});
    open.push_back({first, k});
  }
  return true;
}

std::vector<std::vector<LoopPoint>> simple_loops(std::vector<LoopPoint> loop) {
  std::vector<std::vector<LoopPoint>> simple;
  for (size_t end = 1; end < loop.size();) {
    size_t begin = 0;
    while (begin < end && loop[begin].edge != loop[end].edge) ++begin;
    if (begin == end) {
      ++end;
      continue;
    }
    const auto from = loop.begin() + static_cast<std::ptrdiff_t>(begin),
               to = loop.begin() + static_cast<std::ptrdiff_t>(end);
    if (end - begin > 2) simple.emplace_back(from, to);
    loop.erase(from, to);
    end = begin + 1;
  }
  if (loop.size() > 2) simple.push_back(std::move(loop));
  return simple;
}

}  // namespace soapfilm
