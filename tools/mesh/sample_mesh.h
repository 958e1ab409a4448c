// Points spread over a mesh by area, for measuring it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// The triangles of a mesh in a sequence by cumulative area.
class TrianglesByArea {
 public:
  explicit TrianglesByArea(const Mesh& mesh);

  double total() const { return up_to_.empty() ? 0.0 : up_to_.back(); }
  /// The triangle at the cumulative `area` in [0, total()]; one without area only where all are.
  uint32_t at(double area) const;

 private:
  std::vector<double> up_to_;  // area of each and those before it
};

struct MeshPoint {
  Vec3d position;
  uint32_t triangle = 0;
};

/// `count` points, one at random in each of `count` equal parts of the area, along the order of the triangles. The
/// result does not depend on the number of threads. Throws ParameterError when the mesh has no area.
std::vector<MeshPoint> sample_mesh(const Mesh& mesh, size_t count, uint64_t seed, const Context& context);

}  // namespace soapfilm
