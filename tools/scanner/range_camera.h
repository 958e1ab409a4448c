// The rays of one view: the direction of each pixel of a range image.
#pragma once

#include <numbers>
#include <vector>

#include "soapfilm/core/vec.h"
#include "tools/scanner/pose.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {

inline constexpr double radians = std::numbers::pi / 180;  ///< of a degree

struct RangeCamera {
  Pose pose;
  Rays rays = Rays::central;
  double range = 1;  ///< from scanner to target
  double step = 1;   ///< between neighboring rays: at the target, input units; spinning: of azimuth, radians
  int columns = 1;
  int rows = 1;
  double turn = 0;                   ///< spinning: at which fraction of a step the rotation begins, [0, 1)
  std::vector<double> elevations{};  ///< spinning: of each row, radians

  struct Ray {
    Vec3d origin, direction;
  };
  /// Fractions of a pixel give directions between pixels.
  Ray ray(double column, double row) const;
  /// Distance between neighboring rays, at a point of the given range along one of them; input units.
  double spacing(double along) const;
};

/// The views of `params`, which must be valid. Throws ParameterError when one has too many rays or no direction.
std::vector<RangeCamera> place_cameras(const Box3d& box, const ScannerParams& params);

}  // namespace soapfilm
