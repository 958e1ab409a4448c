// From the whole box to a band: the u of a solver that knows no band, for the one judge and the stages after it.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// What a brick holds.
enum class BrickContent : uint8_t { zero, one, mixed };

/// The bricks in which, or next to which (also by an edge or a corner), the content is not the same constant 0 or 1.
/// `content` of all bricks of the box, x fastest; zero beyond it.
BrickMask interface_bricks(const std::vector<BrickContent>& content, Vec3i bricks);
/// The same from u: the bricks in which, or next to which (also by an edge or a corner), u is not the same constant 0
/// or 1.
BrickMask interface_bricks(const DenseField<float>& u, const LevelBox& box, const Context& context);

/// A level with this u and p = 0, on the support's bricks and the interface's; elsewhere u is constant, 0 or 1.
/// `support` and `f` must outlive the level.
Level level_of(const DenseField<float>& u, const LevelBox& box, float lambda, const BrickGrid& support,
               const Field<float>& f, const Context& context, Norm norm = Norm::isotropic);

}  // namespace soapfilm
