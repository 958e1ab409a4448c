// The appearance of a surface point: one soft key light, a weak fill light, a sky dimmed by ambient occlusion, a faint
// sheen.
#pragma once

#include "tools/render/scene.h"

namespace soapfilm::render_detail {

/// A low-discrepancy sequence in the unit square (Roberts' R2), shifted by a hash of the pixel: every pixel gets an
/// even pattern, neighbors get unrelated ones - a regular dither would look like steps of the surface - and each
/// depends only on the pixel's position.
class PixelPattern {
 public:
  PixelPattern(int x, int y);
  /// The k-th point, both coordinates in [0, 1); k may be negative.
  void point(int k, float& u, float& v) const;

 private:
  double shift_u_, shift_v_;
};

/// Light towards the viewer, linear. Sample number `sample` of the pixel uses its own part of the pattern.
Vec3f shade(const Scene& scene, const SurfacePoint& point, const PixelPattern& pattern, int sample, int occlusion_rays);

}  // namespace soapfilm::render_detail
