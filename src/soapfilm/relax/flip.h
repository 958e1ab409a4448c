// Chooses the diagonals of a mesh's triangles that lie nearer to a smooth surface.
#pragma once

#include <span>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/relax/half_edges.h"

namespace soapfilm {

/// Distance of the middle of an edge from a surface of constant curvature between its ends, by the unit normals there.
inline double sag(Vec3d a, Vec3d b, Vec3f normal_a, Vec3f normal_b) {
  return std::abs(dot(b - a, Vec3d(normal_b - normal_a))) / 8;
}

/// Exchanges the diagonals of pairs of triangles where the other one's middle lies nearer to the surface whose unit
/// normals at the vertices are given, by more than `least_gain` (a length), the largest gains first. A zero normal
/// means unknown: edges there stay. Never folds two triangles over each other or makes one of less than a hundredth of
/// voxel^2, and never makes an edge twice: a manifold stays one. Returns the number of exchanges.
size_t flip_edges(HalfEdges& edges, std::span<const Vec3f> normals, double voxel, double least_gain,
                  const Context& context);

}  // namespace soapfilm
