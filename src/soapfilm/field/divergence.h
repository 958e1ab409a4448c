// f = div v (section 4.1): the data term of the energy, from the samples' directions.
#pragma once

#include <cstdint>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"

namespace soapfilm {

/// Values on the bricks that the samples reach, zero elsewhere. Linear in the samples: other data can be added.
struct SupportField {
  BrickGrid grid;
  Field<float> f;
};

/// Its memory.
constexpr uint64_t support_bytes(uint64_t bricks) { return bricks * brick_volume * sizeof(float); }

/// Each sample's direction is distributed to its eight nearest vertices (trilinear weights), smoothed with the box
/// filter convolved three times with itself (taps (1 3 6 7 6 3 1) / 27 along each axis, sum 1), and its divergence
/// taken by central differences. f > 0 just inside the surface, < 0 just outside; its sum is 0.
/// On the context's device (Device::divergence), else each rank finds a part and gets the others. Bits, in float: each
/// brick adds its samples in their order to vertices of its own, at most one beyond it; a vertex adds what bricks gave
/// it in lattice order, z slowest. Then one pass along each axis, first tap first, x, y, z: of the difference's taps
/// along a component's own axis, of the smoothing's along the others; x and y are added before the pass along z, z
/// after it.
SupportField divergence_field(const GridSamples& samples, const LevelBox& box, const Context& context);

/// The bricks where that f can differ from zero: within 4 vertices of a sample's eight.
BrickMask support_mask(const GridSamples& samples, const LevelBox& box, const Context& context);

}  // namespace soapfilm
