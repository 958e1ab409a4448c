// Which side of the surface each vertex is on: the stage that the methods differ in.
#pragma once

#include <optional>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/progress.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/params.h"
#include "soapfilm/refine/indicator.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// What a method found, in the form that the one judge and the stages after it take.
struct Segmentation {
  Level level;          ///< u in [0, 1] and, where the method has one, its dual p (else 0); refers to the support field
  float threshold = 0;  ///< a vertex is inside where u exceeds it
  /// The field whose level set is the surface, of a method that has a smooth one itself (`poisson`).
  struct LevelSet {
    SurfaceField field;
    double isovalue = 0;
  };
  std::optional<LevelSet> level_set;
};

/// Runs params.method on the data term; fills the method's part of the report. `observe` sees every level of a pyramid
/// that is about to be left. Not for Method::vrip, which works on the scans themselves (fuse/vrip.h).
Segmentation segment(const Lattice& lattice, const SupportField& field, const GridSamples& samples,
                     const ReconstructParams& params, const LevelObserver& observe, const Parallel& parallel,
                     Progress& progress, ReconstructReport& report);

}  // namespace soapfilm
