// How far a scan or a mesh is from its design: signed distances from both sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/mesh.h"
#include "tools/compare/align.h"

namespace soapfilm {

struct CompareOptions {
  double tolerance = 0;    ///< input units, >= 0; 0: no verdict
  double least = 0.99;     ///< share that must be within the tolerance, (0, 1]
  bool align = false;      ///< fit the part to the model first
  size_t points = 300000;  ///< on each mesh, by area; [1, 1e8]
  uint64_t seed = 1;       ///< of the random points
  size_t bins = 21;        ///< of the histograms, [1, 1000]
};

/// Throws ParameterError for the first option out of its range.
void validate(const CompareOptions& options);

/// Signed distances: positive where the part has more material than the model, negative where it has less.
struct Deviations {
  size_t points = 0;
  double mean = 0;  ///< with its sign
  double rms = 0;
  double lowest = 0, highest = 0;
  double percentile95 = 0, percentile99 = 0;  ///< of the distances without signs
  double within = 0, above = 0, below = 0;    ///< shares by the tolerance; without one 0
  double histogram_end = 0;                   ///< bins cover [-end, end] evenly; the outermost have what is beyond, too
  std::vector<size_t> histogram;
};

struct Comparison {
  Deviations part_to_model;  ///< from each sample, or from points spread over the mesh
  /// From points spread over the model to the part's mesh: also what the part lacks. For a scan, whose samples have
  /// gaps between them, none.
  std::optional<Deviations> model_to_part;
  std::optional<Alignment> alignment;
  std::optional<bool> within_tolerance;  ///< the verdict, over both sides
};

/// A part of the two kinds.
struct MeshPart {
  Mesh mesh;
  std::vector<double> distances;  ///< of the vertices, after compare()
};
struct ScanPart {
  PointCloud cloud;
  std::vector<double> distances;
};

/// `part` is moved if options.align says so. The faces of a closed mesh that is inside-out are flipped. The results are
/// the same for any number of threads. Throws ParameterError for options out of range, meshes without area, and as
/// align() does.
Comparison compare(MeshPart& part, const Mesh& model, const CompareOptions& options, const Context& context);
Comparison compare(ScanPart& part, const Mesh& model, const CompareOptions& options, const Context& context);

/// The attribute `distance` and colors: blue below -top, green around 0, red above top (> 0).
Mesh color_by_deviation(const MeshPart& part, double top);
PointCloud color_by_deviation(const ScanPart& part, double top);

}  // namespace soapfilm
