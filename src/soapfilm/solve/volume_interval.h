// Between which volumes all segmentations lie whose energy is almost the optimum's.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/params.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Volumes in vertices of the level, that is in voxels; of the whole domain.
struct VolumeInterval {
  double epsilon = 0;  ///< relative to max(|D|, 1000 lambda), as gaps are
  double least = 0, most = 0;
  double segmented = 0;  ///< of the thresholded solution itself
  int solves = 0;
};

/// How far a segmentation of the interval may be from the solution: vertices, in steps along the axes; and not beyond
/// the band.
inline constexpr int interval_reach = 5;

struct VolumeIntervalSetup {
  float threshold = 0.5f;  ///< of u
  double energy = 0;       ///< of the relaxed u, at least the optimum's
  double epsilon = 1e-3;   ///< > 0
};

/// Bounds the volume of every segmentation that differs from the solution only near its interface and whose energy E is
/// at most the optimum's plus `epsilon`. Let D(s) be the dual energy of the same problem with f + s there, found by the
/// certified solver: V <= (E* + eps - D(s)) / s for every s > 0, and from below with s < 0; the best of several s
/// counts. The bounds are proved, rounding of f + s included. They are no statement about the scanned object: its own
/// energy is above the optimum, too. Leaves the thresholded u in the level, and another p. Throws Cancelled.
VolumeInterval find_volume_interval(Level& level, const VolumeIntervalSetup& setup, const PrimalDualParams& params,
                                    const Context& context);

}  // namespace soapfilm
