// What a remeshed surface keeps as it is: sharp edges and borders, as chains between corners.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/remesh/sides.h"
#include "soapfilm/simplify/connectivity.h"

namespace soapfilm {

/// A stretch of sharp edges, or of the border, between two corners. Vertices move along it, by the length from its
/// beginning.
struct Chain {
  std::vector<uint32_t> vertex;  ///< of the original; the first and the last are different corners
  std::vector<Vec3d> point;      ///< where these belong: on the edge as it was before it was rounded
  std::vector<double> at;        ///< length from the first
  bool border = false;

  double length() const { return at.back(); }
  Vec3d place(double along) const;
};

struct Features {
  static constexpr uint32_t none = Connectivity::none;
  std::vector<Chain> chains;
  std::vector<uint32_t> chain_of_edge;  ///< by half edge
  std::vector<uint8_t> is_corner;       ///< by vertex
  struct Corner {
    uint32_t vertex;
    Vec3d place;  ///< where it belongs
  };
  std::vector<Corner> corners;
};

/// Borders, and edges at which the surface turns from side to side by more than 40 degrees where these go on for a few
/// times `edge`. Corners are where chains meet or end, where one turns by more than 50 degrees within `edge`; a ring
/// gets some.
Features find_features(const Connectivity& mesh, const std::vector<Vec3d>& position, const Sides& sides, double edge);

}  // namespace soapfilm
