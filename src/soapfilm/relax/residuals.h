// The residuals of a fit: the distances of the samples from the surface, searchable by place.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/relax/smooth_field.h"

namespace soapfilm {

/// The samples' signed distances to a surface, sorted by cell. Outliers, and samples that were seen from behind, have
/// less or no weight.
class Residuals {
 public:
  /// `scale` of the robust penalty (Tukey's), voxels. `samples` must outlive it.
  Residuals(const GridSamples& samples, const SmoothField& field, double scale, const Context& context);

  /// How far along the unit `normal` (inwards) the surface should move at a lattice point: the mean over the samples
  /// within a voxel, weighted by nearness and by how well their normals agree, with `prior` samples of distance 0.
  double mean_at(Vec3d point, Vec3d normal) const;

 private:
  struct Entry {
    Vec3f local;   ///< relative to its brick
    Vec3f normal;  ///< unit, inwards
    float distance = 0;
    float weight = 0;
    uint16_t cell = 0;   ///< x + 8 y + 64 z
    uint8_t octant = 0;  ///< of the cell: x + 2 y + 4 z
  };

  /// Calls visit(entry, weight, squared distance along the surface) for the entries within a voxel, with the weights of
  /// mean_at().
  template <class Visit>
  void for_each_near(Vec3d point, Vec3d normal, Visit&& visit) const;
  void find_entries(const GridSamples& samples, const SmoothField& field, float scale, const Context& context);
  /// Of each brick, in [0, 1]: 0 where the samples' distances from the surface are noise, judged by pairs of near
  /// samples, 1 where they are detail that the surface misses. No place is surer of detail than the whole surface.
  std::vector<float> shares_of_surface(const Context& context) const;

  const BrickGrid& bricks_;      ///< the bricks that contain samples
  std::vector<uint32_t> begin_;  ///< first entry of each brick; one more at the end
  std::vector<Entry> entries_;   ///< in each brick by cell and octant
};

}  // namespace soapfilm
