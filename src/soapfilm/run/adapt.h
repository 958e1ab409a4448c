// Levels that adapt: where samples are sparse the surface is that of a coarser level. The rooms are adapt/ and, for the
// triangles, extract/leaf_surface.h.
#pragma once

#include <vector>

#include "soapfilm/adapt/regions.h"
#include "soapfilm/context.h"
#include "soapfilm/finish/attributes.h"
#include "soapfilm/mesh.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/run.h"
#include "soapfilm/run/surface.h"

namespace soapfilm {

/// Of each sample, as LevelSamples has it; empty unless levels adapt.
std::vector<float> sort_spacings(const LocalSurface& surface, const GridSamples& samples, const Grid& grid,
                                 const ReconstructParams& params, const Context& context);

/// The samples with the directions of the solve and, where those differ, of the fit, which `samples` has by now.
LevelSamples level_samples(const GridSamples& samples, const std::vector<Vec3f>& of_solve, std::vector<float> spacings);

/// Which level each place has, and each level's surface.
struct AdaptedSurface {
  Regions regions;
  std::vector<DistanceField> levels;  ///< the finest first; none: the same level everywhere
};

/// The problem of a level.
struct LevelTask {
  const Grid& grid;  ///< of the finest level
  double lambda;     ///< of the finest level
  const ReconstructParams& params;
  const RobustParams& robust;
};

/// The regions, by the samples' spacing, and the surfaces of the coarser levels: each found as that of the finest one,
/// from all samples.
AdaptedSurface find_coarser_surfaces(LevelSamples samples, const LevelTask& task, const Context& context);

/// The surfaces as one mesh, that of the finest level among them; what that has in other levels' places is dropped, and
/// the coarser ones are used up. Says in `details` how many leaves each level has. Throws EmptyResult.
Mesh triangles_of(AdaptedSurface& adapted, Surface& finest, const Lattice& lattice, double lambda,
                  ReportDetails& details, const Context& context);

/// The samples' spacing as a column that rides along with them: "spacing", in input units, not a number where it is
/// unknown. Nothing where the cloud has a column of that name.
void add_spacing(SampleAttributes& attributes, const std::vector<float>& spacings, double voxel);

/// Which level each vertex lies in, as the attribute "level": its voxel is 2^level of the finest ones. Nothing where
/// the mesh has an attribute of that name.
void carry_levels(const Regions& regions, const Lattice& lattice, const Context& context, Mesh& mesh);

/// Says which levels there are.
void announce_levels(const ReportDetails& details, Trace& trace);

}  // namespace soapfilm
