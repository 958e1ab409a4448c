// How far a solution is from the global optimum, at most.
#pragma once

#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/finish/vertex_gap.h"
#include "soapfilm/place/place.h"
#include "soapfilm/report.h"
#include "soapfilm/run/segment.h"
#include "soapfilm/solve/volume_interval.h"

namespace soapfilm {

/// Evaluates the energies of the relaxed and the thresholded solution. Throws EmptyResult where no surface is better
/// than none.
Certificate certify(const Segmentation& found, const Grid& grid, const SupportField& field, double lambda,
                    const ReconstructParams& params, const Context& context);

/// Where the certificate's gap is, if the mesh's vertices are to have it.
std::optional<GapField> find_gap(const Level& level, const Certificate& certificate, const ReconstructParams& params,
                                 const Context& context);

/// The interval that params.surface.volume_interval asks for. Leaves the thresholded u in the level, and another p.
VolumeInterval volumes_near(Level& level, const Certificate& certificate, const ReconstructParams& params,
                            const Context& context);

}  // namespace soapfilm
