// The stages before the solve: from a cloud to samples with directions on a grid, and lambda. Each stage is implemented
// in the folder of its name; here it gets its part of the parameters.
#pragma once

#include <span>
#include <vector>

#include "soapfilm/border/border.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/lambda/choose.h"
#include "soapfilm/orient/find_directions.h"
#include "soapfilm/params.h"
#include "soapfilm/place/place.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/trace.h"

namespace soapfilm {

/// The samples' box. Throws SamplesError where there are too few to span a volume; ParameterError where Method::vrip
/// gets something else than range scans.
Box3d check_cloud(const PointCloud& cloud, const ReconstructParams& params, const Context& context);

/// Keeps the directions from before planes replaced them if the refinement needs them.
Orientation find_directions(const PointCloud& cloud, const Box3d& box, const ReconstructParams& params,
                            const Context& context);

/// From where the samples were seen.
struct Scanners {
  std::vector<Vec3d> positions;  ///< input frame
  Surroundings surroundings;     ///< if needed to choose the border
  bool from_above = false;       ///< none is known; all samples are taken as seen from above
};
Scanners find_scanners(const PointCloud& cloud, const OrientReport& directions, const ReconstructParams& params,
                       const Context& context);

struct Placed {
  Grid grid;
  GridSamples samples;
};
/// The grid, and the samples sorted into it. Throws MemoryError before arrays larger than the samples are allocated.
Placed place(const PointCloud& cloud, const Box3d& box, const Orientation& oriented, const Scanners& scanners,
             const ReconstructParams& params, MemoryBudget& memory, const Context& context);

/// Lambda on the grid. Where it is not given, each sample is weighted by the area that it represents: its direction
/// gets that length. (Where it is given, it is the paper's: against one unit vector for each sample.)
Lambda choose_lambda(const PointCloud& cloud, const Orientation& oriented, const Scanners& scanners, const Grid& grid,
                     const ReconstructParams& params, GridSamples& samples, const Context& context);

/// A column of the cloud's directions in the order of the samples, each as long as the sample's own.
std::vector<Vec3f> sort_views(std::span<const Vec3f> views, const GridSamples& samples, const Lattice& lattice,
                              const Context& context);

/// What lies beyond the samples' box. `field` is restored at the end.
BorderReport find_border(SupportField& field, const Grid& grid, double lambda, const Scanners& scanners,
                         const ReconstructParams& params, const Context& context, Trace& trace);

/// Where solid matter lies beyond, reverses the data term and all directions: the complement is solved.
void reverse_for_solid(const BorderReport& border, SupportField& field, GridSamples& samples, std::vector<Vec3f>& views,
                       const Context& context);

/// If `given` normals look into a body, not into a room, what they face once they are reversed is the body itself: then
/// air lies beyond after all.
void find_reversed_body(BorderReport& border, const OrientReport& given, const Scanners& scanners,
                        const ReconstructParams& params, const GridSamples& samples, const Context& context);

}  // namespace soapfilm
