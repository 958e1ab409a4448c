// The stages after the solve: from a solution to its mesh. What each of them does is in the folder of its name.
#pragma once

#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"
#include "soapfilm/refine/indicator.h"
#include "soapfilm/refine/refine.h"
#include "soapfilm/refine/robust_fit.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/segment.h"
#include "soapfilm/run/trace.h"

namespace soapfilm {

/// An open solution, closed along the box for the stages until cut_at_border(). Throws MemoryError.
Level closed_along_box(const Level& level, MemoryBudget& memory, const Context& context);

/// Drops components and cavities that too few samples support, where that is wanted.
std::optional<ComponentReport> drop_unsupported(Level& level, const GridSamples& samples, const Grid& grid,
                                                const ReconstructParams& params, Trace& trace, const Context& context);

/// Where the scanners stand in the solution.
ScannerReport stand_scanners(const Level& level, const Scanners& scanners, const Grid& grid, const BorderReport& border,
                             const ReconstructParams& params);

/// A field, and the level set of it that is the surface.
struct Surface {
  SurfaceField field;
  double isovalue = 0;
  std::optional<FitReport> refine;  ///< when it was moved onto the samples
  double scale = 0;                 ///< of what samples may still lie off it, voxels
};

/// What users read of it.
std::optional<RefineReport> summary_of(const Surface& surface);

/// The level set on the samples, sub-voxel accurate, or the paper's (section 4.4); or the one that the method has found
/// itself. Throws MemoryError.
Surface find_surface(Segmentation found, const GridSamples& samples, const Grid& grid, const ReconstructParams& params,
                     const RobustParams& robust, MemoryBudget& memory, const Context& context);

/// Throws EmptyResult where the level set is empty.
Mesh triangles_of(const Surface& surface, const Lattice& lattice, double lambda, const Context& context);

/// Makes the triangles follow a refined surface where it bends; not under noise.
std::optional<RelaxReport> relax(Mesh& mesh, const Surface& surface, const GridSamples& samples, const Grid& grid,
                                 const ReconstructParams& params, Trace& trace, const Context& context);

/// A complement's faces turn back, and what closed an open surface goes.
void undo_border(Mesh& mesh, const BorderReport& border, const Lattice& lattice);

/// Takes away what no sample is near, where that is wanted.
std::optional<TrimReport> trim(Mesh& mesh, const GridSamples& samples, const Grid& grid, const BorderReport& border,
                               const ReconstructParams& params, Trace& trace, const Context& context);

/// Method::vrip: the surface of the range images, open where nothing was seen. Throws EmptyResult.
Mesh fuse(const PointCloud& cloud, const Lattice& lattice, const ReconstructParams& params, VripReport& report,
          Trace& trace, const Context& context);

}  // namespace soapfilm
