// One item prepared for rays: geometry in the camera's frame, colors, normals.
#pragma once

#include <memory>
#include <optional>

#include "soapfilm/context.h"
#include "tools/render/render.h"

namespace soapfilm::render_detail {

/// Where a ray meets the item; camera frame, scene units.
struct SurfacePoint {
  Vec3f position;
  Vec3f geometric_normal;  ///< unit, towards the viewer
  Vec3f normal;            ///< unit, for shading
  Vec3f color;             ///< linear light
  bool is_back = false;    ///< seen from the inside
};

/// Lanes of one packet of occlusion rays.
inline constexpr int packet = 8;
struct OcclusionRays {
  int count = 0;
  float x[packet], y[packet], z[packet];  ///< directions
  float reach[packet];                    ///< scene units
  float visible[packet];                  ///< result: 1 where the ray is unobstructed, else 0
};

/// The item in the camera's frame, shifted and scaled so that it fits a unit ball around the origin: floats then
/// suffice for georeferenced data, and lateral coordinates of rays are exact.
class Scene {
 public:
  /// `center` is the world point at the origin, `scale` scene units per world unit; `range` that of the color map.
  Scene(const RenderItem& item, const RenderParams& params, const ViewFrame& frame, Vec3d center, double scale,
        std::pair<double, double> range, const Context& context);
  ~Scene();
  Scene(Scene&&) noexcept;

  /// The visible point at (x, y) of the picture plane, scene units.
  std::optional<SurfacePoint> look_at(float x, float y) const;

  /// Follows rays from a surface point.
  void test_occlusion(const SurfacePoint& from, OcclusionRays& rays) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace soapfilm::render_detail
