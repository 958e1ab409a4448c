// From the thresholded solve to a surface that lies on the samples: sub-voxel accuracy, the same topology.
#pragma once

#include <cstdint>
#include <optional>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/choose/fit_weights.h"
#include "soapfilm/refine/fit/robust_fit.h"
#include "soapfilm/refine/holes/hole_report.h"
#include "soapfilm/refine/topology/start.h"
#include "soapfilm/refine/topology/topology.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/level.h"
#include "soapfilm/surface/indicator.h"

namespace soapfilm {

/// What users set, and what follows from other parameters or was fixed by measurement.
struct RefineSetup : RefineParams {
  RobustParams robust{};
  bool vanish = true;  ///< components and cavities of at most 64 vertices that the fit shrinks to their last one are
                       ///< removed: no surface fits their samples
  bool open = false;   ///< may the surface end at the border of the box? If so, holes do not bulge beyond it
};

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const RefineSetup& params);

struct FitReport {
  FitWeights fit_weights;    ///< in use
  FitWeightReport search;    ///< how it was found
  HoleReport holes;          ///< where no sample covers the surface
  double spacing = 1;        ///< of the vertices that the fit worked on, voxels: 1, 2, 4, ...
  size_t band_vertices = 0;  ///< on either side of the surface
  size_t down_weighted = 0;  ///< samples of weight < 1/4, including those outside the band
  size_t flips = 0;          ///< vertices that changed their label
  size_t refused = 0;        ///< vertices that would have changed the topology and did not
  size_t vanished = 0;       ///< components and cavities that the fit shrank to their last vertex, which changed too
  int iterations = 0;        ///< conjugate-gradient steps on the whole band
};

/// Moves the level set of the binary indicator u > threshold onto the samples (design note in displacement.h): the
/// level set 0 of the result is the surface; it is positive inside and about the signed distance in voxels near it. Its
/// components and genus are the indicator's, except for what has vanished: only simple points change their label, one
/// after the other.
/// `density`: samples per voxel^2 of surface, 0 where it is not known. `level` is freed early when it is moved in. The
/// result does not depend on the number of threads.
class Refinement {
 public:
  /// Builds the band around the surface, its holes filled, and frees `level`. Keeps references to the samples, the
  /// parameters, `context` and the report. Throws ParameterError.
  Refinement(Level level, float threshold, const GridSamples& samples, double density, const RefineSetup& params,
             const Context& context, FitReport& report);

  /// Rows of eight vertices that the fit works on: its memory is proportional to them.
  size_t rows() const { return start_.band.rows(); }
  /// Are samples so few that fits on coarser grids are tried?
  bool tries_coarser() const { return sparse_; }
  /// Call only once.
  SurfaceField fit();

 private:
  void fill_holes(Level& level);

  const RefineSetup& params_;
  const Context& context_;
  const GridSamples& samples_;
  double density_;
  float threshold_;
  bool sparse_;
  FitReport& report_;
  Start start_;
  std::optional<SignBits> signs_;     ///< on the start's bricks
  Level indicator_;                   ///< where sparse: on every second vertex
  std::optional<FitWeights> chosen_;  ///< if they were needed for holes
};

/// Both steps at once.
SurfaceField refine(Level level, float threshold, const GridSamples& samples, double density, const RefineSetup& params,
                    const Context& context, FitReport& report);

}  // namespace soapfilm
