// The stage that decides the grid: voxel, lattice, lambda that follows from the sampling, memory.
#pragma once

#include <span>

#include "soapfilm/core/context.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/core/progress.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/plan.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// The samples' box. Throws SamplesError unless there are at least 4 samples, all finite, that span a volume.
Box3d check_samples(const PointCloud& cloud, const Context& context);

/// What the run may take. Throws MemoryError where the samples alone, on any grid, take more.
Room check_room(const PointCloud& cloud, const ReconstructParams& params);

/// Places the grid, sorts the samples into it and fills the report's input and lattice. `box` is what
/// check_samples() told, `room` what check_room(). Throws MemoryError before what is large beside the samples is
/// allocated.
GridSamples place(const PointCloud& cloud, const Box3d& box, std::span<const Vec3f> directions,
                  const LocalSurface& surface, const ReconstructParams& params, const Room& room,
                  const Context& context, ReconstructReport& report);

/// Fills certificate.lambda: as given, by the samples' density, or by cross-validation (the report's `select`); warns
/// when it is near the one where the film vanishes. Where lambda is not given, the samples of parts that it would lose
/// for their thin sampling are weighed up (the report's `thin`): their directions in `samples` get longer.
void weigh_area(const PointCloud& cloud, std::span<const Vec3f> directions, const LocalSurface& surface,
                const ReconstructParams& params, const Context& context, GridSamples& samples,
                ReconstructReport& report);

}  // namespace soapfilm
