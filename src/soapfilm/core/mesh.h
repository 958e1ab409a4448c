#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/core/box.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

using Triangle = std::array<uint32_t, 3>;

/// Indexed triangles; counter-clockwise seen from outside.
struct Mesh {
  struct Attribute {
    std::string name;
    std::vector<float> values;  ///< one per vertex
  };

  std::vector<Vec3d> vertices;  ///< input units and frame
  std::vector<Triangle> triangles;
  std::vector<Vec3f> normals;  ///< per vertex, unit, outward; empty when absent
  std::vector<Rgb8> colors;    ///< per vertex; empty when absent
  std::vector<Attribute> attributes;

  Box3d box() const;
  double area() const;
  /// Enclosed volume by the divergence theorem; positive when the orientation is outward.
  double volume() const;
};

}  // namespace soapfilm
