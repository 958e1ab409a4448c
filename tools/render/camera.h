// Orthographic cameras: their direction and the window of the view that they show.
#pragma once

#include <string_view>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// A right-handed frame: the picture's right, its up, and the direction towards the viewer. Unit vectors.
struct ViewFrame {
  Vec3d right{1, 0, 0};
  Vec3d up{0, 1, 0};
  Vec3d towards_viewer{0, 0, 1};

  /// Components of a world vector along the three.
  Vec3d apply(Vec3d v) const { return {dot(v, right), dot(v, up), dot(v, towards_viewer)}; }
};

/// The frame of a viewer who stands at `from` seen from the object, with `up` upright in the picture; looking along
/// `up`, the object's front is at the bottom of the picture (from above) or at the top (from below).
/// Throws ParameterError when a vector is zero or not finite.
ViewFrame view_frame(Vec3d from, Vec3d up);

/// Where the viewer stands for "front", "back", "left", "right", "top", "bottom" or "iso". With y up the front is
/// towards +z, with z up towards -y, as modeling programs have it; right is +x in both. Throws ParameterError for
/// another name.
Vec3d view_direction(std::string_view name, Vec3d up);

/// A rectangle of the picture plane: center and half the height in view units, width over height of the panel.
struct ViewWindow {
  double x = 0;
  double y = 0;
  double half_height = 1;
};

/// Extent of what is shown along the picture's right and up.
struct ViewExtent {
  double lo_x = 0, hi_x = 0, lo_y = 0, hi_y = 0;
};

ViewExtent extent_of(const std::vector<Vec3d>& positions, const ViewFrame& frame);

/// Part of the picture, in fractions of its width and height from the upper left corner; x0 < x1, y0 < y1. It may
/// reach beyond [0, 1].
struct ZoomBox {
  double x0 = 0, y0 = 0, x1 = 1, y1 = 1;
};

/// The whole of `window` cut down to `zoom`, enlarged along one side to keep the panel's shape.
ViewWindow zoomed(const ViewWindow& window, const ZoomBox& zoom, double aspect);

}  // namespace soapfilm
