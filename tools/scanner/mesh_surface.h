// A triangle mesh that can be scanned.
#pragma once

#include <memory>

#include "soapfilm/context.h"
#include "tools/mesh/distance.h"
#include "tools/scanner/surface.h"

namespace soapfilm {

/// Orientation of the faces of a mesh: outward flips a closed one whose volume is negative; as_given keeps a room seen
/// from inside as it is.
enum class Faces { outward, as_given };

/// Rays and closest points by Embree, refined in double against the triangle found: positions lie on the mesh to double
/// precision whatever the coordinates' offset. A closed mesh with negative volume is inside-out; its faces are flipped.
/// An open one is kept as it is: the sign of its volume means nothing.
class MeshSurface final : public Surface {
 public:
  /// Throws InputError when the mesh has no triangle, a vertex index out of range, or a coordinate that is not finite.
  MeshSurface(Mesh mesh, const Context& context, Faces faces = Faces::outward);
  ~MeshSurface() override;

  /// A triangle is hit from its inner side too; the normal stays outward. It is zero where the triangle has no area.
  std::optional<SurfacePoint> intersect(Vec3d origin, Vec3d direction) const override;
  SurfacePoint closest(Vec3d p) const override;
  Box3d box() const override { return box_; }
  Mesh tessellate(double tolerance) const override;
  std::optional<double> volume() const override { return closed_ ? std::optional(mesh_.volume()) : std::nullopt; }
  std::optional<double> area() const override { return mesh_.area(); }
  std::vector<SurfacePoint> closest_points(const std::vector<Vec3d>& points, const Context& context) const override;

  const Mesh& mesh() const { return mesh_; }
  bool reversed() const { return turned_; }

 private:
  struct Rays;

  Mesh mesh_;
  Box3d box_;
  bool closed_ = false;
  bool turned_ = false;
  std::unique_ptr<Rays> rays_;
  std::unique_ptr<ClosestPointQuery> closest_point_;
};

}  // namespace soapfilm
