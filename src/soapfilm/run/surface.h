// The stages after the solve: from a solution to its mesh. Each is implemented in the folder of its name.
#pragma once

#include <optional>
#include <variant>

#include "soapfilm/context.h"
#include "soapfilm/finish/rays.h"
#include "soapfilm/fuse/vrip.h"
#include "soapfilm/mesh.h"
#include "soapfilm/refine/fit/robust_fit.h"
#include "soapfilm/refine/refine.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/trace.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// Drops components and cavities supported by too few samples, if enabled.
std::optional<ComponentReport> drop_unsupported(Labels& labels, const GridSamples& samples, const Grid& grid,
                                                const ReconstructParams& params, Trace& trace, const Context& context);

/// Where the scanners stand in the solution.
ScannerReport stand_scanners(const Labels& labels, const Scanners& scanners, const Grid& grid,
                             const BorderReport& border);

/// Values on a grid, and the level set of them that is the surface.
struct Surface {
  std::variant<IndicatorField, DistanceField> field;
  double isovalue = 0;
  std::optional<FitReport> refine;  ///< when it was moved onto the samples
  double scale = 0;                 ///< of the samples' residuals, voxels

  const SurfaceField& values() const {
    return std::visit([](const SurfaceField& f) -> const SurfaceField& { return f; }, field);
  }
  float missing_value(Vec3i brick) const {
    return std::visit([&](const auto& f) { return f.missing_value(brick); }, field);
  }
};

/// The part of it that users read.
std::optional<RefineReport> summary_of(const Surface& surface);

/// How the surface is moved onto the samples.
RefineSetup refine_setup(const Grid& grid, const ReconstructParams& params, const RobustParams& robust);

/// The surface between the labels, moved onto the samples with sub-voxel accuracy, or the paper's (section 4.4). Throws
/// MemoryError.
Surface find_surface(Labels labels, const GridSamples& samples, const Grid& grid, const ReconstructParams& params,
                     const RobustParams& robust, MemoryBudget& memory, const Context& context);

/// Of an open lattice only what is in front of its border. Throws EmptyResult where there is none.
Mesh triangles_of(const Surface& surface, const Lattice& lattice, double lambda, const Context& context);

/// Makes the triangles follow the curvature of a refined surface; not under noise.
std::optional<RelaxReport> relax(Mesh& mesh, const Surface& surface, const GridSamples& samples, const Grid& grid,
                                 const ReconstructParams& params, Trace& trace, const Context& context);

/// Reverses the faces and directions of a complement: they are the scene's again.
void undo_border(Mesh& mesh, GridSamples& samples, const BorderReport& border);

/// Warns of a closed mesh whose volume is negative, where neither the user nor a scanner says that it is a hollow.
void warn_inside_out(const Mesh& mesh, const BorderReport& border, const Scanners& scanners,
                     const ReconstructParams& params, Trace& trace);

/// Removes surface far from all samples, if enabled. Throws EmptyResult where none is left.
std::optional<TrimReport> trim(Mesh& mesh, const GridSamples& samples, std::vector<Ray> rays, const Grid& grid,
                               const ReconstructParams& params, Trace& trace, const Context& context);

/// Method::vrip: the surface of the range images, open where nothing was seen. Throws EmptyResult.
Mesh fuse(const PointCloud& cloud, const Lattice& lattice, const ReconstructParams& params, VripReport& report,
          Trace& trace, const Context& context);

}  // namespace soapfilm
