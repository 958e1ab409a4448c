// The end of a run: a look at what came out, and the report.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/finish/attributes.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/trace.h"

namespace soapfilm {

/// The report as far as it is known before the solve.
ReconstructReport facts_of(const PointCloud& cloud, const Box3d& box, const ReconstructParams& params,
                           const OrientReport& directions, const Grid& grid, const Lambda& lambda,
                           const std::shared_ptr<ReportDetails>& details);

/// What lies beyond the box, and the grid that follows from it.
void report_border(const BorderReport& border, const Lattice& lattice, ReconstructReport& report,
                   ReportDetails& details);

/// What rides along with the samples, on the vertices.
void carry(const SampleAttributes& attributes, const GridSamples& samples, const Lattice& lattice, Trace& trace,
           const Context& context, Mesh& mesh);

/// How much the mesh holds of the samples, its attributes, and the rest of the report: mesh, times, memory, warnings.
Reconstruction finish(Mesh mesh, ReconstructReport report, const GridSamples& samples, const Lattice& lattice,
                      const MemoryBudget& memory, Trace& trace, const Context& context);

}  // namespace soapfilm
