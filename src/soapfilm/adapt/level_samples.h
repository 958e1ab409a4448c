// The samples on other levels of the lattice than their own.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/brick_mask.h"

namespace soapfilm {

/// Samples of one level with what the surface around each one is like.
struct LevelSamples {
  GridSamples samples;
  std::vector<Vec3f> views;    ///< directions for the fit, where they differ from the samples'; else empty
  std::vector<float> spacing;  ///< of different samples around each one (LocalSurface), in voxels of the placed level;
                               ///< 0: unknown
};

/// Those for which keep(brick, sample) says so.
LevelSamples select(const LevelSamples& level, const std::function<bool(size_t, uint32_t)>& keep,
                    const Context& context);

/// The same samples on the next coarser level, whose vertex I lies between the vertices 2I and 2I + 1 along each axis.
LevelSamples on_next_level(const LevelSamples& fine, Vec3i coarse_bricks, const Context& context);
/// The samples in some bricks, on the next finer level.
LevelSamples on_finer_level(const LevelSamples& coarse, const BrickMask& in, Vec3i fine_bricks, const Context& context);

}  // namespace soapfilm
