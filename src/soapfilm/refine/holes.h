// Holes in the sampling: the film of least area spans them flat; here it bends as the surface around it does.
//
// On every second vertex, where no sample is near: the fit of refine/displacement.h with its curvature term, signs that
// follow it at simple points, and again from there, since one fit moves a surface by no more than its band is wide.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/start.h"
#include "soapfilm/refine/strength.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// How the surface spans what no sample covers: with the bend of the surface around, or as the film of least area.
enum class HoleFill { smooth, flat };

struct HoleReport {
  size_t bent = 0;     ///< holes
  size_t left = 0;     ///< left flat: the unseen base of an object, or a film that ends at the grid's border
  size_t flips = 0;    ///< vertices of the grid that changed sides
  size_t refused = 0;  ///< that would have changed the topology and were held
  int rounds = 0;      ///< of fits and flips; 12 are the most
};

/// Finds films that no sample holds. Cost beyond a look at each sample follows their area.
class HoleFinder {
 public:
  /// All must outlive it. `start` is the level's.
  HoleFinder(const Level& level, const Start& start, const GridSamples& samples, const Parallel& parallel);

  /// Vertices I of every second one (vertex 2 I of the grid) at the films that are to bend: those that lie farther than
  /// two voxels from all samples near the surface, in parts of at least 24, which is a hole some 14 voxels wide. Not
  /// what lies along a face of the samples' box while the surface around meets it steeply (an unseen base), nor what
  /// touches the grid's border, nor anything in a box that is open.
  std::vector<Vec3i> film_to_bend(HoleReport& report) const;

  /// Is a sample near vertex I of every second one? Outliers do not count: those that the first surface is not near.
  bool is_sampled(Vec3i vertex) const;

 private:
  static constexpr int side = half_brick + 1;  // of every second vertex around a brick's samples
  bool is_base(const std::vector<Vec3i>& film) const;
  Vec3f gradient(Vec3i vertex) const;
  bool is_near_surface(Vec3i vertex) const;

  const Level& level_;
  const Start& start_;
  const GridSamples& samples_;
  std::vector<std::array<uint8_t, static_cast<size_t>(side) * side>> near_;  // of each brick of samples
  Vec3f lo_, hi_;  // box of the samples near the surface, vertices
};

/// Bends the surface of u > threshold at these films; `level` becomes a binary indicator (its box, grid, u and inside
/// alone), `start` the start from it. Components and genus stay. `strength` is what the samples of the whole grid are
/// fitted with. Bulges end at the grid's border; where more than 3 % of the vertices that want to turn may not, all
/// stays as it was. Results do not depend on threads.
void bend_holes(Level& level, float threshold, const std::vector<Vec3i>& film, const HoleFinder& finder,
                const Strength& strength, Start& start, const GridSamples& samples, double reach,
                const Parallel& parallel, HoleReport& report);

}  // namespace soapfilm
