// Embree's tree over some triangles of a mesh; internal, included by no public header.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"
#include "tools/mesh/embree_scene.h"

namespace soapfilm {

struct ClosestPoint;

/// What all trees of a mesh have in common.
struct TreeFrame {
  Vec3d center;
  double to_unit = 1;  ///< scale under which a tree spans [-1, 1]: no float overflows

  /// Throws ParameterError as ClosestPointQuery does.
  static TreeFrame of(const Mesh& mesh);
  /// Relative to the center. Throws ParameterError for a vertex that does not exist.
  Vec3d corner(const Mesh& mesh, size_t triangle, int k) const;
};

/// Triangles [begin, end), copied. The tree is in float with boxes rounded outward, every candidate is measured in
/// double relative to the frame's center, so that no result depends on the shape of the tree.
class TriangleTree {
 public:
  TriangleTree(const Mesh& mesh, const TreeFrame& frame, size_t begin, size_t end, const Context& context);
  TriangleTree(const TriangleTree&) = delete;  // Embree holds its address
  TriangleTree& operator=(const TriangleTree&) = delete;

  /// `point` and the result are relative to the center; triangles farther than `limit` need not be examined: of a
  /// result without a triangle the distance is infinite.
  ClosestPoint search(Vec3d point, double limit = std::numeric_limits<double>::infinity()) const;

 private:
  using Corners = std::array<Vec3d, 3>;
  struct Search;

  static void bounds(const RTCBoundsFunctionArguments* args);
  static bool visit(RTCPointQueryFunctionArguments* args);
  float reach(double distance, Vec3d point) const;

  double to_unit_;
  size_t first_;  ///< of the mesh's triangles
  std::vector<Corners> triangles_;
  EmbreeScene scene_;
};

}  // namespace soapfilm
