// The simplified mesh with what the original's vertices have: normals, colors, attributes.
#pragma once

#include <array>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/simplify/collapsed_mesh.h"
#include "soapfilm/simplify/face_grid.h"

namespace soapfilm {

/// Corners of an original triangle and their weights, which sum to one, the largest first.
struct Blend {
  std::array<uint32_t, 3> vertex;
  std::array<double, 3> weight;
};

/// The weights of the point of a triangle's plane nearest to p, moved into the triangle.
Blend blend_at(Vec3d p, const Triangle& vertex, Vec3d a, Vec3d b, Vec3d c);

/// Gives the vertices of `to` normals, colors and attributes, one blend each.
void append_blended(Mesh& to, const Mesh& from, const std::vector<Blend>& blends);

/// A vertex that moved gets values of the nearest point of the original, which lies within `distance`: between the
/// corners of a triangle; of labels, the nearest corner's. Vertices and triangles keep their order. Vertices in no
/// triangle of the original stay.
Mesh carry_over(const Mesh& mesh, const CollapsedMesh& now, const FaceGrid& grid, double distance,
                const Context& context);

}  // namespace soapfilm
