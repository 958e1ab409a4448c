// Defaults that depend on other parameters.
#pragma once

#include "soapfilm/params.h"

namespace soapfilm {

/// Is the surface moved onto the samples (refine/refine.h), or is it the paper's?
inline bool refines(const ReconstructParams& params) {
  return params.surface.refine.value_or(params.method == Method::tv && !params.surface.isovalue);
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
