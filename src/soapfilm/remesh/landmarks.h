// Places of the original that the new surface must stay near.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// Some vertices of the original, each looked after by a vertex of the mesh as it is now: a collapse hands them over.
/// What changes around a vertex may not leave those that it looks after. So a thin ear, of which each change takes only
/// a little, is not lost.
class Landmarks {
 public:
  using Corners = std::array<Vec3d, 3>;

  /// One of the places in each cell of that `side`; each place looks after itself. `distance`: how far the surface may
  /// be from a landmark.
  Landmarks(const std::vector<Vec3d>& places, double side, double distance);

  /// Whether those of `vertex` stay near, or at least get no farther, where triangles that `were` around it `become`
  /// others.
  bool stay_near(uint32_t vertex, const std::vector<Corners>& were, const std::vector<Corners>& become) const;
  void hand_over(uint32_t gone, uint32_t kept);

 private:
  static constexpr uint32_t none = ~uint32_t{0};

  std::vector<Vec3d> place_;
  std::vector<uint32_t> next_;          // by landmark: the next one of the same vertex
  std::vector<uint32_t> first_, last_;  // by vertex
  double squared_distance_;
};

}  // namespace soapfilm
