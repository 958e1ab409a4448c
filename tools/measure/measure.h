// Area, volume and extents of a mesh, and all that `soapfilm measure` finds, as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"
#include "tools/measure/above_plane.h"
#include "tools/measure/columns.h"
#include "tools/measure/section.h"

namespace soapfilm {

struct MeasureOptions {
  std::optional<Plane> above;  ///< volumes on both sides of it
  std::vector<Plane> sections;
  ColumnOptions columns;  ///< of the volumes between two meshes; its window holds for `above` too
};

struct Measures {
  TopologyReport topology;
  Box3d box;
  double area = 0;               ///< input units^2
  std::optional<double> volume;  ///< of a closed mesh, >= 0
  bool inside_out = false;       ///< its faces look inward, as of a room seen from inside
  std::optional<VolumeAtPlane> at_plane;
  std::optional<VolumesBetween> above_mesh;
  std::optional<VolumesBetween> since;
  std::vector<Section> sections;
};

/// `base` is what to measure the volume above of, `before` the same place at an earlier time; either may be absent.
/// Throws ParameterError for a mesh without triangles, and for a window beside a plane that is not horizontal.
Measures measure(const Mesh& mesh, const MeasureOptions& options, const Context& context, const Mesh* base = nullptr,
                 const Mesh* before = nullptr);

/// What was measured, as the user named it.
struct MeasureSubject {
  std::string mesh, base, before;  ///< empty: none
  std::string unit;                ///< of lengths, such as "m"; only shown; empty: not known
  double voxel = 0;                ///< > 0: the change of volume per offset of that size is given
  MeasureOptions options;
};

std::string measure_table(const MeasureSubject& subject, const Measures& measures);
nlohmann::ordered_json measure_json(const MeasureSubject& subject, const Measures& measures);

}  // namespace soapfilm
