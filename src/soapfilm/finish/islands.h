// Drops what too few samples vouch for: specks that outliers leave outside, bubbles that they leave inside.
#pragma once

#include <cstddef>

#include "soapfilm/core/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// A part's surface is the one between it and the part around it. Its support is the share of the samples that such an
/// area has in the mean of the whole surface.
struct IslandParams {
  double min_support = 0.2;    ///< parts with less support are dropped, >= 0; 1 is a surface sampled like the whole
  int few_samples = 5;         ///< parts of fewer samples are dropped whatever their support, >= 0
  int many_samples = 100;      ///< parts of so many samples stay down to thin_support, >= 0
  double thin_support = 0.01;  ///< a surface sampled a hundred times less than the whole, >= 0
};

struct IslandCount {
  size_t kept = 0;
  size_t dropped = 0;
};

struct IslandReport {
  IslandCount objects;  ///< parts of the inside
  IslandCount voids;    ///< parts of the outside but the outermost
  size_t samples =
      0;            ///< by their weights, on the surfaces of dropped parts; one that lies on two of them counts twice
  double area = 0;  ///< of these surfaces, voxel^2
  size_t vertices = 0;         ///< that changed sides
  double highest_dropped = 0;  ///< support of the dropped part that has most; 0 without one
  double lowest_kept = 0;      ///< and of the kept part that has least
};

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const IslandParams& params);

/// Moves the parts of u > threshold (finish/parts.h) that their samples do not support to the side around them, voids
/// like objects: there u becomes 0 or 1. `density` is in samples per voxel^2 of surface. A sample supports the surface
/// that it lies on when it looks across it, from inside to outside, by its weight. Where no object would stay, the one
/// with most samples does. Doing it twice changes nothing more; the result does not depend on the number of threads.
void drop_islands(Level& level, float threshold, const GridSamples& samples, double density, const IslandParams& params,
                  const Context& context, IslandReport& report);

}  // namespace soapfilm
