// Levels that adapt: where samples are sparse the surface is that of a coarser level than the placed one, the grid's,
// and where they are dense that of a finer one. The rooms are adapt/, pyramid/solve_in_places.h and, for the triangles,
// extract/leaf_surface.h.
#pragma once

#include <cstdint>
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

/// Which level each place has, and each level's surface.
struct AdaptedSurface {
  Lattice lattice;                     ///< of the finest level; the placed one is its level `lattice.added`
  Regions regions;                     ///< all places have the placed level: levels do not adapt
  std::vector<DistanceField> levels;   ///< the finest first
  std::vector<GridSamples> in_places;  ///< of the levels below the placed one, with the directions of the fit
};

/// The surfaces as one mesh, that of the placed level among them; what levels have in others' places is dropped. Only
/// the finer levels' are kept. Says in `details` how many leaves each level has, and how large. Throws EmptyResult.
Mesh triangles_of(AdaptedSurface& adapted, Surface& placed, double lambda, ReportDetails& details,
                  const Context& context);

/// relax() of the placed level's triangles, and then of the finer levels'.
std::optional<RelaxReport> relax(Mesh& mesh, const Surface& surface, const GridSamples& samples,
                                 const AdaptedSurface& adapted, const Grid& grid, const ReconstructParams& params,
                                 Trace& trace, const Context& context);

/// The samples' spacing as a column that rides along with them: "spacing", in input units, not a number where it is
/// unknown. Nothing where the cloud has a column of that name.
void add_spacing(SampleAttributes& attributes, const std::vector<float>& spacings, double voxel);

/// Which level each vertex lies in, as the attribute "level": its voxel is 2^level of the finest ones. Nothing where
/// the mesh has an attribute of that name.
void carry_levels(const AdaptedSurface& adapted, const Context& context, Mesh& mesh);

/// Says which levels there are.
void announce_levels(const ReportDetails& details, Trace& trace);

}  // namespace soapfilm
