// The simplified mesh with what the original's vertices have: normals, colors, attributes.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/simplify/collapsed_mesh.h"
#include "soapfilm/simplify/face_grid.h"

namespace soapfilm {

/// A vertex that moved gets values of the nearest point of the original, which lies within `distance`: between the
/// corners of a triangle; of labels, the nearest corner's. Vertices and triangles keep their order. Vertices in no
/// triangle of the original stay.
Mesh carry_over(const Mesh& mesh, const CollapsedMesh& now, const FaceGrid& grid, double distance,
                const Context& context);

}  // namespace soapfilm
