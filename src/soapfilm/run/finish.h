// The end of a run: the self-check, and the report.
#pragma once

#include <memory>
#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/finish/attributes.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/certify.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/trace.h"

namespace soapfilm {

/// The part of the report that is known before the solve.
ReconstructReport facts_of(const PointCloud& cloud, const Box3d& box, const ReconstructParams& params,
                           const OrientReport& directions, const Grid& grid, const Lambda& lambda,
                           const std::shared_ptr<ReportDetails>& details);

/// What lies beyond the box, and the grid that follows from it.
void report_border(const BorderReport& border, const Lattice& lattice, ReconstructReport& report,
                   ReportDetails& details);

/// What rides along with the samples, on the vertices.
void carry(const SampleAttributes& attributes, const GridSamples& samples, const Lattice& lattice, Trace& trace,
           const Context& context, Mesh& mesh);

/// And where the certificate's gap is, if that was found.
void carry(const std::optional<GapField>& gap, const Lattice& lattice, Trace& trace, const Context& context,
           Mesh& mesh);

/// The self-check, the mesh's attributes, and the rest of the report: mesh, times, memory, warnings.
Reconstruction finish(Mesh mesh, ReconstructReport report, const GridSamples& samples, const Lattice& lattice,
                      const MemoryBudget& memory, Trace& trace, const Context& context);

}  // namespace soapfilm
