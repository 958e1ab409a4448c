// Which side of the surface each vertex is on: the stage in which the methods differ.
#pragma once

#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/report.h"
#include "soapfilm/run/details.h"
#include "soapfilm/solve/graph_cut.h"
#include "soapfilm/solve/level.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// The result of a method, in the form needed by the energy evaluator and the later stages.
struct Segmentation {
  Level level;  ///< u in [0, 1] and, where the method has one, its dual p (else 0); refers to the support field
  std::optional<IndicatorField> surface;  ///< of a method that finds a smooth field itself (poisson): its level set 1/2
  SolveReport report;
};

/// Of a graph cut, by the parameters.
GraphCutSetup graph_cut_setup(const ReconstructParams& params);

/// Runs params.method on the data term. Not for Method::vrip, which works on the scans themselves (fuse/vrip.h).
Segmentation segment(const Lattice& lattice, const SupportField& field, const GridSamples& samples, double lambda,
                     const ReconstructParams& params, const PyramidObserver& observe, const Context& context);

}  // namespace soapfilm
