// A connected piece of a surface: where an object was not measured.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "tools/scanner/surface.h"

namespace soapfilm {

/// The part of a surface that contains `share` of its area and spreads from a point chosen by the seed: all that can be
/// reached from there along the surface within a ball, whose radius follows. So a plate loses one of its sides, not
/// both. The patch depends only on the surface, the share and the seed, not on how the surface is sampled.
class SurfacePatch {
 public:
  /// `share` in [0, 1], as measured with 40,000 even samples. Throws ParameterError when it is out of range.
  SurfacePatch(const Surface& surface, double share, uint64_t seed);
  ~SurfacePatch();

  /// `on_surface` as given by surface.closest(): the normal distinguishes the sides of a thin wall.
  bool contains(const SurfacePoint& on_surface) const;

  Vec3d center() const;  ///< a point of the surface

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace soapfilm
