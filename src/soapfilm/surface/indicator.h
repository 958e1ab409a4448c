// Section 4.4: from the labels to the smooth field whose level set is the surface.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/brick_mask.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// The bricks within 4 vertices of the interface.
BrickMask bricks_near_surface(const Labels& labels, const Context& context);

/// The labels, 1 inside, smoothed with the filter of section 4.1; values in [0, 1]. Its bricks are
/// bricks_near_surface(). Beyond an open border it goes on as it is in front of it.
IndicatorField smoothed_indicator(const Labels& labels, const Context& context);
/// The same on given bricks, of labels whose grid may be a part of their band: right where it holds the 26 around.
IndicatorField smoothed_indicator(const Labels& labels, BrickGrid bricks, const Context& context);
/// The same, but the values of `wanted` bricks alone; 0 in the others.
IndicatorField smoothed_indicator(const Labels& labels, BrickGrid bricks, const Context& context, ItemRange wanted);

/// The same without smoothing: 0 and 1 on the same bricks.
IndicatorField binary_indicator(const Labels& labels, const Context& context);
IndicatorField binary_indicator(const Labels& labels, BrickGrid bricks, const Context& context);

/// The mean of the field at the samples (trilinear interpolation, equal weights): the paper's isovalue.
double mean_at_samples(const IndicatorField& field, const GridSamples& samples, const Context& context);

}  // namespace soapfilm
