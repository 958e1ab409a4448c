// From the whole box to a band: the u of a solver that has no band, for the energy evaluation and the later stages.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// What a brick holds.
enum class BrickContent : uint8_t { zero, one, mixed };

/// The bricks that are not the same constant 0 or 1 as all their neighbors (also across edges and corners). `content`
/// of all bricks of the box, x fastest; zero beyond it.
BrickMask interface_bricks(const std::vector<BrickContent>& content, Vec3i bricks);
/// The same, with the content computed from u.
BrickMask interface_bricks(const DenseField<float>& u, const LevelBox& box, const Context& context);

/// A level with this u and p = 0, on the support's bricks and the interface's; elsewhere u is constant, 0 or 1.
/// `support` and `f` must outlive the level.
Level level_of(const DenseField<float>& u, const LevelBox& box, float lambda, const BrickGrid& support,
               const Field<float>& f, const Context& context, Norm norm = Norm::isotropic);

}  // namespace soapfilm
