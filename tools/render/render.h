// Pictures of meshes and point clouds: orthographic rays by Embree, soft light, ambient occlusion.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/mesh.h"
#include "tools/render/camera.h"
#include "tools/render/image.h"

namespace soapfilm {

/// One panel of a picture. The mesh or cloud must outlive the call.
///
/// Color of a vertex or sample: the attribute that RenderParams::color_by names, else its own color, else the scan's
/// (clouds of several scans), else RenderParams::surface. Samples with a normal are discs, others small balls.
struct RenderItem {
  std::variant<const Mesh*, const PointCloud*> shape;
  std::string caption;
};

enum class Shading {
  flat,    ///< each triangle has its own normal: shows the actual triangles
  smooth,  ///< normals interpolated between vertices; computed from the triangles when the mesh has none
};

enum class Framing {
  shared,    ///< all panels show the same window of space: for surfaces of one object in one frame
  centered,  ///< each panel is centered on its own item; the scale is the same in all
  fitted,    ///< each panel has the center and the scale that show its item in full
};

struct RenderParams {
  int width = 800;   ///< of a panel, pixels, 16 .. 16384
  int height = 800;  ///< of a panel without its caption, pixels, 16 .. 16384
  int columns = 0;   ///< panels in a row, >= 0; 0: all in one row up to four, then about as many rows as columns

  Vec3d from{0, 0, 1};  ///< where the viewer stands, seen from the object; any length, not zero
  Vec3d up{0, 1, 0};    ///< upright in the picture; any length, not zero
  ZoomBox zoom;         ///< the part of the full picture to show
  Framing framing = Framing::shared;

  Shading shading = Shading::flat;
  int samples = 3;          ///< rays along each side of a pixel, 1 .. 16
  int occlusion_rays = 5;   ///< for each of these samples, 0 .. 255; 0: no occlusion
  double point_radius = 0;  ///< input units, >= 0; 0: from the spacing of the samples

  std::string color_by;                            ///< name of a vertex attribute; empty: none
  std::optional<std::pair<double, double>> range;  ///< values at the map's ends, first < second; else as found
  Rgb8 surface{222, 204, 180};
  Rgb8 back{196, 60, 48};  ///< the inside of a surface: seen through holes or where it is inside-out
  std::optional<Rgb8> background = Rgb8{255, 255, 255};  ///< transparent when absent
};

/// The panels in rows, captions below them, and below all the legend of the color map when one is used. Every pixel is
/// computed independently from fixed sample patterns: the same bytes for any number of threads.
///
/// Throws ParameterError when there is no item, an item is empty or has a coordinate that is not finite, an attribute
/// is in none of the items, or a parameter is out of range.
Image render(const std::vector<RenderItem>& items, const RenderParams& params, const Context& context);

}  // namespace soapfilm
