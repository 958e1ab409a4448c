// From a point cloud to a watertight surface: the whole pipeline in one call.
#pragma once

#include <array>

#include "soapfilm/report.h"

namespace SOAPFILM_API soapfilm {

struct Reconstruction {
  Mesh mesh;
  ReconstructReport report;
};

/// Reconstructs the surface from which the cloud's samples were taken (Pan and Skala 2011, sections 3 and 4). The mesh
/// is in the cloud's frame and units, closed and manifold; where the surface may end (Border::open, Method::vrip,
/// trimmed) a manifold with boundary. The same cloud and parameters give the same mesh, bit for bit, for any number of
/// threads and any SIMD target.
/// Throws ParameterError (a parameter out of range, samples that span no volume, coordinates that are not finite),
/// MemoryError before anything large is allocated, EmptyResult, Cancelled.
Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Context& context);

/// The same, and frees the cloud once its samples are on the grid: its memory is free during the solve.
Reconstruction reconstruct(PointCloud&& cloud, const ReconstructParams& params, const Context& context);

/// Scans as they come; at any time the surface of those that are there, the same bytes as from all in one cloud.
class Reconstructor {
 public:
  /// `pose`: rows of the 4 x 4 matrix from the scan's frame to the common one; the scanner's place if that is unknown.
  /// Throws ParameterError, and adds nothing, for columns of different lengths or a pose that shears or mirrors.
  void add(PointCloud scan, const std::array<double, 16>* pose = nullptr);
  const PointCloud& cloud() const { return cloud_; }  ///< all of them, in the common frame
  Reconstruction reconstruct(const ReconstructParams& params, const Context& context) const;

 private:
  PointCloud cloud_;
};

}  // namespace soapfilm
