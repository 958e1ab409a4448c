// Finds the films that no sample holds and that are to bend as the surface around them does.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/hole_report.h"
#include "soapfilm/refine/start.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// A hole's film: vertices I of every second one (vertex 2 I of the grid).
using HoleFilm = std::vector<Vec3i>;

/// Finds films that no sample holds. Cost beyond a look at each sample follows their area.
class HoleFinder {
 public:
  /// All must outlive it. `start` is the level's.
  HoleFinder(const Level& level, const Start& start, const GridSamples& samples, const Context& context);

  /// The films that are to bend: vertices on the surface that lie farther than two voxels from all samples near it, in
  /// parts of at least 24, which is a hole some 14 voxels wide. Not what is more than a fifth of the surface, nor what
  /// lies along a face of the samples' box while the surface around meets it steeply (an unseen base), nor what touches
  /// the grid's border: `report` counts these.
  std::vector<HoleFilm> films_to_bend(HoleReport& report) const;

  /// Is a sample near vertex I of every second one? Outliers do not count: those that the first surface is not near.
  bool is_sampled(Vec3i vertex) const;

  const Start& start() const { return start_; }
  const GridSamples& samples() const { return samples_; }

 private:
  static constexpr int side = half_brick + 1;  // of every second vertex around a brick's samples
  bool is_base(const HoleFilm& film) const;
  Vec3f gradient(Vec3i vertex) const;
  bool is_near_surface(Vec3i vertex) const;

  const Level& level_;
  const Start& start_;
  const GridSamples& samples_;
  std::vector<std::array<uint8_t, static_cast<size_t>(side) * side>> near_;  // of each brick of samples
  Vec3f lo_, hi_;  // box of the samples near the surface, vertices
};

}  // namespace soapfilm
