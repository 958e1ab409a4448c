// The 256 cases of marching cubes (Lorensen and Cline 1987), generated from a rule instead of typed in, so that the
// surface is a closed 2-manifold for every labeling of the grid.
//
// The rule. A corner is inside or outside. On each face of the cell the contour keeps the inside on its right: going
// round the face counter-clockwise, seen from outside the cell, it joins the edge where a run of inside corners begins
// to the edge where that run ends. A face whose diagonals disagree thus always separates its two inside corners - one
// fixed choice for every ambiguous face, as Montani, Scateni and Scopigno 1994 make it; Nielson and Hamann 1991 explain
// why any choice that is a function of the face alone leaves no hole: the neighbor cell sees the same face mirrored
// and draws the same segments backwards. Every cell edge that changes sign ends one segment and begins another, so the
// segments of a cell close up into loops; each loop is filled with triangles.
//
// Why it is a manifold. Triangle edges are loop segments, shared with the one neighbor across their face, or
// diagonals. A diagonal whose ends lie on one face could be drawn a second time by the neighbor cell, and an edge with
// four triangles would result; the triangulation uses none. (Every loop that this rule draws has such a triangulation;
// joining the inside corners instead would draw longer loops, some of which have none.) Around a surface vertex each of
// the four cells contributes one fan, joined across the four faces into one ring.
//
// One case needs more than loops: exactly two outside corners at the ends of a body diagonal. They are joined by a tube
// (a ring of six triangles) instead of being capped. With it the surface is, for every labeling, the boundary of a
// neighborhood of the inside vertices taken 6-connected, and of the outside vertices taken 26-connected: components
// and genus of the mesh are those of digital topology, and its Euler characteristic is 2 (V - E + F - C) of the
// inside's vertices, unit edges, unit squares and unit cubes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace soapfilm::marching_cubes {

/// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2); a case is the 8-bit mask of its inside corners.
inline constexpr int corner_count = 8;
inline constexpr int edge_count = 12;
inline constexpr int case_count = 256;

/// Edge e runs along axis e / 4, from edge_corner(e) to edge_corner(e) + (1 << axis); the two low bits of e are the
/// coordinates of the edge on the next two axes (cyclic).
constexpr int edge_axis(int edge) { return edge / 4; }
constexpr int edge_corner(int edge) {
  const int axis = edge_axis(edge);
  return (edge & 1) << (axis + 1) % 3 | (edge >> 1 & 1) << (axis + 2) % 3;
}

/// The edge between two neighboring corners.
constexpr int edge_between(int corner_a, int corner_b) {
  const int axis = (corner_a ^ corner_b) >> 1;  // 1, 2, 4 -> 0, 1, 2
  return 4 * axis + (corner_a >> (axis + 1) % 3 & 1) + 2 * (corner_a >> (axis + 2) % 3 & 1);
}

/// Whether both edges lie on one face of the cell.
constexpr bool share_face(int edge_a, int edge_b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (edge_axis(edge_a) == axis || edge_axis(edge_b) == axis) continue;
    if (((edge_corner(edge_a) ^ edge_corner(edge_b)) >> axis & 1) == 0) return true;
  }
  return false;
}

/// The corners of face f (axis f / 2, low side for even f) counter-clockwise, seen from outside the cell.
constexpr std::array<int, 4> face_corners(int face) {
  const int axis = face / 2;
  const int b = 1 << (axis + 1) % 3;
  const int c = 1 << (axis + 2) % 3;
  const int side = (face & 1) << axis;
  if (face & 1) return {side, side | b, side | b | c, side | c};
  return {side, side | c, side | b | c, side | b};
}

/// The longest contour loop and the most triangles that a case has.
inline constexpr int longest_loop = 7;
inline constexpr int most_triangles = 6;

/// What a cell draws: triangles between the surface points on its edges, counter-clockwise seen from outside.
struct Case {
  int triangle_count = 0;
  std::array<std::array<uint8_t, 3>, most_triangles> triangles{};
};

/// All cases, indexed by the mask of inside corners; built at the first call.
const std::array<Case, case_count>& cases();

/// Exactly two outside corners, opposite through the body of the cell: the case with a tube.
bool is_tunnel(int inside);

/// The contour loops of a case as edges in order; the surface is on their left, seen from outside the surface.
std::vector<std::vector<int>> trace_loops(int inside);

}  // namespace soapfilm::marching_cubes
