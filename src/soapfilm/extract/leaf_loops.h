// Triangles of a loop of surface points in a cell whose corners may be the same leaf. Internal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Points of the surface in one cell: which edge of the grid each lies on, and where.
struct LoopPoint {
  uint64_t edge;
  Vec3d place;
};

/// The edges on each of a cell's six faces that the surface cuts; `no_edge` for others.
constexpr uint64_t no_edge = ~uint64_t{0};
using FaceEdges = std::array<std::array<uint64_t, 4>, 6>;

/// The triangles, as indices into the loop, with the shortest diagonals (squares added up) of which none joins two
/// points on one face: the neighbor there could draw it, too. False where there are no such triangles: then a point in
/// the middle has to join them all.
bool triangulate_loop(const std::vector<LoopPoint>& loop, const FaceEdges& faces,
                      std::vector<std::array<int, 3>>& triangles);

/// The loop without points that follow themselves, in parts where it meets itself. Parts of less than three points are
/// left out.
std::vector<std::vector<LoopPoint>> simple_loops(std::vector<LoopPoint> loop);

}  // namespace soapfilm
