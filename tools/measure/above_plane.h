// How much of a mesh lies above and below a plane: exact, by clipping its triangles.
#pragma once

#include <optional>

#include "soapfilm/mesh.h"
#include "tools/measure/plane.h"

namespace soapfilm {

/// A vertical prism: x and y of the corners.
struct Window {
  double lo_x = 0, lo_y = 0, hi_x = 0, hi_y = 0;
};

/// Of a closed mesh: what it encloses on each side of the plane; the two add up to its volume. Of an open sheet: what
/// lies between it and the plane, straight along the normal, where it is above and where it is below the plane; parts
/// that look down count negative, so that overhangs are right. An open mesh that looks up about as much as down is no
/// sheet but a body with holes: as a closed one, but without what a hole's lid would add.
struct VolumeAtPlane {
  double above = 0;  ///< input units^3
  double below = 0;
  double footprint_above = 0;  ///< area of the surface's part above, projected onto the plane, what looks down negative
  double footprint_below = 0;  ///< (of a closed mesh the two cancel)
  bool is_sheet = false;
};

/// `closed` says how to read the mesh. Exact but for rounding: the flux of (height x normal), whose divergence is 1 and
/// which does not pass through the plane nor through walls along its normal, so no cap is needed. With a window, which
/// needs a vertical normal, only what is within it. Faces of a sheet that looks down are turned.
VolumeAtPlane volume_at_plane(const Mesh& mesh, bool closed, const Plane& plane,
                              const std::optional<Window>& window = std::nullopt);

}  // namespace soapfilm
