// A mesh in the course of being edited, beside the original.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/mesh.h"
#include "soapfilm/simplify/connectivity.h"
#include "soapfilm/simplify/written.h"

namespace soapfilm {

/// Positions are in the local frame of `written`.
struct EditedMesh {
  static constexpr uint32_t none = Connectivity::none;

  /// Throws ParameterError where the mesh is no 2-manifold.
  EditedMesh(const Mesh& mesh, const Written& written_as);

  const Written& written;
  Connectivity was;             ///< the original's triangles: faces
  Connectivity mesh;            ///< now
  std::vector<Vec3d> original;  ///< vertices
  std::vector<Vec3d> position;  ///< now

  Vec3d corner(uint32_t triangle, size_t k) const { return position[mesh.corners(triangle)[k]]; }
  std::array<Vec3d, 3> corners(uint32_t triangle) const {
    return {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  }
  size_t count_alive() const;
};

}  // namespace soapfilm
