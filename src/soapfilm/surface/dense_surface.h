// The level set of a function on the whole box: the interface from solvers without a band, and without bounds of u, to
// the later stages.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// The mean of u at the samples (trilinear interpolation, equal weights): Kazhdan's isovalue.
double mean_at_samples(const DenseField<float>& u, const GridSamples& samples, const Context& context);

/// The solid {u > isovalue}, in two forms that agree at every vertex.
struct DenseSurface {
  DenseField<float> binary;  ///< 1 inside, 0 outside: for the energy evaluator common to all methods (see level_of())
  IndicatorField field;      ///< u / (2 isovalue): the surface is its level set at 1/2
};

/// The bricks of `field` are those in which, or next to which, the solid begins or ends, so extract_isosurface() with
/// the isovalue 1/2 draws a closed surface. `u` is 0 at the fixed vertices of `box` and outside.
/// Throws ParameterError unless isovalue > 0: else the outside of the box would be inside the solid.
DenseSurface dense_surface(const DenseField<float>& u, double isovalue, const LevelBox& box, const Context& context);

}  // namespace soapfilm
