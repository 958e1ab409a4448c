#include "soapfilm/extract/marching_cubes_table.h"

#include <algorithm>
#include <limits>

namespace soapfilm::marching_cubes {

namespace {

constexpr int no_edge = -1;
constexpr int impossible = std::numeric_limits<int>::max() / 4;

bool is_inside(int inside, int corner) { return (inside >> corner & 1) != 0; }

void add_triangle(Case& out, int a, int b, int c) {
  out.triangles[out.triangle_count++] = {static_cast<uint8_t>(a), static_cast<uint8_t>(b), static_cast<uint8_t>(c)};
}

/// next[e]: where the contour goes from edge e, on the face where it begins there.
std::array<int, edge_count> contour_segments(int inside) {
  std::array<int, edge_count> next;
  next.fill(no_edge);
  for (int face = 0; face < 6; ++face) {
    const auto corners = face_corners(face);
    for (int i = 0; i < 4; ++i) {
      if (is_inside(inside, corners[i]) || !is_inside(inside, corners[(i + 1) % 4])) continue;
      int last = (i + 1) % 4;
      while (is_inside(inside, corners[(last + 1) % 4])) last = (last + 1) % 4;
      next[edge_between(corners[i], corners[(i + 1) % 4])] = edge_between(corners[last], corners[(last + 1) % 4]);
    }
  }
  return next;
}

/// Squared length of a diagonal between edge midpoints, in half units; impossible when it would lie in a face.
int diagonal_cost(int edge_a, int edge_b) {
  if (share_face(edge_a, edge_b)) return impossible;
  int sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto twice = [axis](int edge) { return edge_axis(edge) == axis ? 1 : 2 * (edge_corner(edge) >> axis & 1); };
    const int difference = twice(edge_a) - twice(edge_b);
    sum += difference * difference;
  }
  return sum;
}

/// The triangulation of a loop with the shortest diagonals and none in a face of the cell, by the classical dynamic
/// programme over sub-polygons.
class Polygon {
 public:
  explicit Polygon(const std::vector<int>& loop) : loop_(loop), size_(static_cast<int>(loop.size())) {
    for (int span = 2; span < size_; ++span) {
      for (int first = 0; first + span < size_; ++first) choose_apex(first, first + span);
    }
  }

  void append_triangles(Case& out) const { append(0, size_ - 1, out); }

 private:
  /// The best triangle on the chord first-last, all of the sub-polygon first..last being on one side of it.
  void choose_apex(int first, int last) {
    int best = impossible;
    for (int apex = first + 1; apex < last; ++apex) {
      const int sum = cost_[first][apex] + cost_[apex][last];
      if (sum >= best) continue;
      best = sum;
      apex_[first][last] = apex;
    }
    const bool is_side = first == 0 && last == size_ - 1;
    cost_[first][last] = std::min(impossible, best + (is_side ? 0 : diagonal_cost(loop_[first], loop_[last])));
  }

  void append(int first, int last, Case& out) const {
    if (last - first < 2) return;
    const int apex = apex_[first][last];
    add_triangle(out, loop_[first], loop_[apex], loop_[last]);
    append(first, apex, out);
    append(apex, last, out);
  }

  const std::vector<int>& loop_;
  int size_;
  std::array<std::array<int, longest_loop>, longest_loop> cost_{};  // zero for the loop's own segments
  std::array<std::array<int, longest_loop>, longest_loop> apex_{};
};

/// A ring of six triangles between the loops around two opposite corners. Both loops visit the axes in opposite
/// senses; each edge of one meets, on the other, the two edges along the other axes, with which it shares no face.
void join_by_tube(const std::vector<int>& a, const std::vector<int>& b, Case& out) {
  int start = 0;
  while (edge_axis(b[start]) != edge_axis(a[2])) ++start;
  for (int i = 0; i < 3; ++i) {
    const int a_next = a[(i + 1) % 3];
    const int b_here = b[(start + 3 - i) % 3];
    add_triangle(out, a[i], a_next, b_here);
    add_triangle(out, a_next, b[(start + 2 - i) % 3], b_here);
  }
}

Case build_case(int inside) {
  Case out;
  const auto loops = trace_loops(inside);
  if (is_tunnel(inside)) {
    join_by_tube(loops[0], loops[1], out);
    return out;
  }
  for (const auto& loop : loops) Polygon(loop).append_triangles(out);
  return out;
}

}  // namespace

bool is_tunnel(int inside) {
  for (int corner = 0; corner < corner_count / 2; ++corner) {
    if ((~inside & 0xff) == (1 << corner | 1 << (7 - corner))) return true;
  }
  return false;
}

std::vector<std::vector<int>> trace_loops(int inside) {
  auto next = contour_segments(inside);
  std::vector<std::vector<int>> loops;
  for (int start = 0; start < edge_count; ++start) {
    if (next[start] == no_edge) continue;
    auto& loop = loops.emplace_back();
    for (int edge = start; next[edge] != no_edge;) {
      loop.push_back(edge);
      const int following = next[edge];
      next[edge] = no_edge;
      edge = following;
    }
  }
  return loops;
}

const std::array<Case, case_count>& cases() {
  static const std::array<Case, case_count> table = [] {
    std::array<Case, case_count> built;
    for (int inside = 0; inside < case_count; ++inside) built[inside] = build_case(inside);
    return built;
  }();
  return table;
}

}  // namespace soapfilm::marching_cubes
