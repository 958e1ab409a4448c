// From a point cloud to a watertight surface: the whole pipeline in one call. Start reading in reconstruct.cpp.
#pragma once

#include <stdexcept>

#include "soapfilm/core/context.h"
#include "soapfilm/core/mesh.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/core/progress.h"
#include "soapfilm/params.h"
#include "soapfilm/report.h"

namespace soapfilm {

struct Reconstruction {
  Mesh mesh;
  ReconstructReport report;
};

/// The optimum is the empty surface: its outcome, not a fault of the input. The message names lambda and the largest
/// one that keeps a surface.
struct EmptyResult : std::runtime_error {
  EmptyResult(const std::string& message, double largest) : std::runtime_error(message), largest_lambda(largest) {}
  double largest_lambda;  ///< that keeps a surface; 0 when there is none
};

/// Reconstructs the surface of which the cloud's samples were taken (Pan and Skala 2011, sections 3 and 4). The mesh is
/// closed and manifold, in the cloud's frame and units. The same cloud and parameters give the same mesh, bit for bit,
/// for any number of threads and any SIMD target.
///
/// By Method::vrip it is open where nothing was seen. `observe` sees the levels of Method::tv.
///
/// Throws ParameterError (a parameter out of range, samples that span no volume, coordinates that are not finite),
/// MemoryError before anything large is allocated, EmptyResult, Cancelled.
Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Context& context,
                           const PyramidObserver& observe = {});

/// The same, and frees the cloud once its samples are on the grid: a large cloud does not stay beside the solve.
Reconstruction reconstruct(PointCloud&& cloud, const ReconstructParams& params, const Context& context,
                           const PyramidObserver& observe = {});

/// Fills what costs another look at the result: the report's topology and the samples' distances to the mesh.
void check_result(Reconstruction& result, const PointCloud& cloud, const Context& context);

}  // namespace soapfilm
