// A triangle mesh, the output, and its topology.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"

namespace SOAPFILM_API soapfilm {

using Triangle = std::array<uint32_t, 3>;

/// Indexed triangles; counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3d> vertices;  ///< input units and frame
  std::vector<Triangle> triangles;
  std::vector<Vec3f> normals;  ///< per vertex, unit, outward; empty when absent
  std::vector<Rgb8> colors;    ///< per vertex; empty when absent
  std::vector<Column> attributes;

  Box3d box() const;
  double area() const;
  double volume() const;  ///< enclosed, by the divergence theorem; positive when the orientation is outward
};

/// A set of triangles connected through shared vertices.
struct MeshComponent {
  size_t vertices = 0;
  size_t edges = 0;
  size_t triangles = 0;
  bool closed_manifold = true;  ///< every edge in exactly two triangles, every vertex one fan, orientation consistent

  int64_t euler_characteristic() const;
  /// Number of handles, (2 - Euler characteristic) / 2; only a closed manifold has one.
  std::optional<int64_t> genus() const;
};

struct TopologyReport {
  size_t vertices = 0;
  size_t triangles = 0;
  size_t edges = 0;
  size_t boundary_edges = 0;              ///< in one triangle
  size_t non_manifold_edges = 0;          ///< in three or more triangles
  size_t misoriented_edges = 0;           ///< in two triangles that run through it in the same direction
  size_t non_manifold_vertices = 0;       ///< whose triangles form more than one fan
  size_t duplicate_triangles = 0;         ///< beyond the first with the same three vertices, in any order
  size_t degenerate_triangles = 0;        ///< with a repeated vertex; they take part in no other count
  size_t zero_area_triangles = 0;         ///< three different vertices, height below 1e-12 of the longest side
  size_t unreferenced_vertices = 0;       ///< in no triangle
  std::vector<MeshComponent> components;  ///< in the order of their lowest vertex

  int64_t euler_characteristic() const;  ///< vertices in use - edges + triangles
  /// Sum over the components; absent when one of them is not a closed manifold.
  std::optional<int64_t> genus() const;
  /// No boundary: it has triangles, and every edge lies in two or more.
  bool closed() const { return triangles > degenerate_triangles && boundary_edges == 0; }
  /// Every edge in at most two triangles that agree on its direction, every vertex one fan, no triangle twice or with
  /// a repeated vertex.
  bool manifold() const;
  /// closed() and manifold(), without zero-area triangles or unreferenced vertices: what soapfilm promises to write.
  bool watertight() const;
};

/// Throws ParameterError when a triangle names a vertex that does not exist.
TopologyReport check_topology(const Mesh& mesh);

/// Summary of a set of distances; all zero when the set is empty.
struct DistanceSummary {
  size_t count = 0;
  double mean = 0;
  double rms = 0;
  double maximum = 0;
  double percentile95 = 0;  ///< the smallest value that 95 % of the distances do not exceed
  double percentile99 = 0;
};

}  // namespace soapfilm
