// Defaults that depend on other parameters.
#pragma once

#include "soapfilm/core/method.h"
#include "soapfilm/params.h"

namespace soapfilm {

/// Is the surface moved onto the samples (refine/refine.h), or is it the paper's? Where levels adapt, it must be: their
/// surfaces are joined by their distances.
inline bool refines(const ReconstructParams& params) {
  const bool as_a_rule = params.method == Method::tv || (params.place.adapt && adapts(params.method));
  return params.surface.refine.value_or(as_a_rule && !params.surface.isovalue);
}

/// Are parts supported by few samples dropped (components/components.h)? The paper's surface keeps them.
inline bool drops_components(const ReconstructParams& params) {
  return params.surface.drop_components.value_or(refines(params));
}

/// Is surface far from all samples removed (finish/trim.h)? `ends`: see BorderReport.
inline bool trims(const ReconstructParams& params, bool ends) {
  return params.method != Method::vrip &&
         params.trim.on.value_or(params.trim.distance || params.trim.fill_holes || ends);
}

/// Is the mesh simplified (simplify/)?
inline bool simplifies(const SimplifyParams& params) {
  return params.tolerance || params.tolerance_vox || params.automatic || params.triangles;
}

}  // namespace soapfilm
