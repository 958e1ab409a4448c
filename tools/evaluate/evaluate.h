// Compares a mesh with the truth: two-sided distances, normals, F-scores, volume, topology, self-intersections.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/progress.h"
#include "tools/mesh/distance.h"
#include "tools/scanner/surface.h"

namespace soapfilm {

struct EvaluationOptions {
  size_t points = 300000;                   ///< on each of the two surfaces, by area; [1, 1e8]
  std::vector<double> f_score_distances{};  ///< input units, each > 0 and finite
  uint64_t seed = 1;                        ///< for the random points
};

/// Throws ParameterError for the first option out of its range.
void validate(const EvaluationOptions& options);

/// Distances from points of one surface to the other.
struct DirectedError {
  DistanceSummary distance;  ///< input units
  /// Degrees in [0, 180] between the oriented normals there and here. A triangle without area has no normal: points on
  /// one, or closest to one, are not counted.
  DistanceSummary angle;
};

/// Knapitsch et al. 2017: precision is the share of the mesh within `distance` of the truth, recall the share of the
/// truth within it of the mesh, the score their harmonic mean.
struct FScore {
  double distance = 0;
  double precision = 0;
  double recall = 0;

  double score() const { return precision + recall > 0.0 ? 2.0 * precision * recall / (precision + recall) : 0.0; }
};

/// The mesh's value and the true one; absent for the volume of a surface that is not closed.
struct Compared {
  std::optional<double> mesh;
  std::optional<double> truth;

  /// (mesh - truth) / truth.
  std::optional<double> relative_error() const {
    if (!mesh || !truth || *truth == 0.0) return std::nullopt;
    return (*mesh - *truth) / *truth;
  }
};

struct Evaluation {
  DirectedError truth_to_mesh;
  DirectedError mesh_to_truth;
  std::optional<DistanceSummary> samples_to_mesh;
  std::vector<FScore> f_scores;  ///< in the order of the options
  Compared volume;
  Compared area;
  TopologyReport topology;        ///< of the mesh
  TopologyReport truth_topology;  ///< of the truth, of a shape's tessellation
  size_t self_intersections = 0;  ///< pairs of triangles, see count_self_intersections()
};

/// Compares `mesh` with `truth`: a Shape, whose closest points and normals are exact, or a MeshSurface. Points are
/// spread over both surfaces by area, one at random in each of equal parts of it, so that means converge fast; maxima
/// are those of the points. `samples`, if given, are compared with the mesh. The normal of a mesh is its triangles'.
/// The result does not depend on the number of threads.
///
/// Throws ParameterError when an option is out of range, the mesh has no area or is broken, or a sample is not finite.
Evaluation evaluate(const Mesh& mesh, const Surface& truth, const EvaluationOptions& options, const Context& context,
                    const std::vector<Vec3d>* samples = nullptr);

/// The same against a mesh. The faces of a closed truth that is inside-out are flipped.
Evaluation evaluate(const Mesh& mesh, const Mesh& truth, const EvaluationOptions& options, const Context& context);

/// `mesh` with each vertex's distance to the truth as the attribute `distance` (input units) and as colors: dark at 0,
/// bright at `top` (input units, > 0 and finite) and beyond.
Mesh color_by_error(Mesh mesh, const Surface& truth, double top, const Context& context);

}  // namespace soapfilm
