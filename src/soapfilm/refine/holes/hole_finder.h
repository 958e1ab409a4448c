// Finds the parts of the minimal surface without samples that shall get the curvature of the surface around them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/holes/hole_report.h"
#include "soapfilm/refine/topology/start.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// The minimal surface over a hole: vertices I of the half-resolution grid (vertex 2 I of the grid).
using HoleSurface = std::vector<Vec3i>;

/// Finds parts of the surface without samples. Reads each sample once; otherwise the cost is proportional to their
/// area.
class HoleFinder {
 public:
  /// Both must outlive it.
  HoleFinder(const Start& start, const GridSamples& samples, const Context& context);

  /// The holes to curve: vertices on the surface that lie farther than two voxels from all samples near it, in
  /// connected parts of at least 24, which is a hole about 14 voxels wide. Excluded, and counted in `report`: more than
  /// a fifth of the surface; parts along a face of the samples' box where the surface around meets it steeply (an
  /// unseen base); parts that touch the border of the grid.
  std::vector<HoleSurface> holes_to_curve(const Context& context, HoleReport& report) const;

  /// Is a sample near vertex I of the half-resolution grid? Outliers, far from the first surface, do not count.
  bool is_sampled(Vec3i vertex) const;

  const Start& start() const { return start_; }
  const GridSamples& samples() const { return samples_; }

 private:
  static constexpr int side = half_brick + 1;  // half-resolution vertices around a brick's samples
  bool is_base(const HoleSurface& hole) const;
  Vec3f gradient(Vec3i vertex) const;
  bool is_near_surface(Vec3i vertex) const;

  const Start& start_;
  const GridSamples& samples_;
  std::vector<std::array<uint8_t, static_cast<size_t>(side) * side>> near_;  // of each brick of samples
  Vec3f lo_, hi_;  // box of the samples near the surface, vertices
};

}  // namespace soapfilm
