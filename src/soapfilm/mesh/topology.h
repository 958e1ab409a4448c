// What a mesh is as a surface: closed, manifold, oriented; its components and their genus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/core/mesh.h"

namespace soapfilm {

/// A set of triangles connected through shared vertices.
struct MeshComponent {
  size_t vertices = 0;
  size_t edges = 0;
  size_t triangles = 0;
  bool closed_manifold = true;  ///< every edge in exactly two triangles, every vertex one fan, orientation consistent

  int64_t euler_characteristic() const {
    return static_cast<int64_t>(vertices) - static_cast<int64_t>(edges) + static_cast<int64_t>(triangles);
  }
  /// Number of handles, (2 - Euler characteristic) / 2; only a closed manifold has one.
  std::optional<int64_t> genus() const {
    if (!closed_manifold) return std::nullopt;
    return (2 - euler_characteristic()) / 2;
  }
};

/// Counts of everything that can be wrong with a mesh, and what kind of surface it is.
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

  /// Vertices in use - edges + triangles.
  int64_t euler_characteristic() const;
  /// Sum over the components; absent when one of them is not a closed manifold.
  std::optional<int64_t> genus() const;

  /// A surface without border: it has triangles, and every edge lies in two or more.
  bool closed() const { return triangles > degenerate_triangles && boundary_edges == 0; }
  /// Every edge in at most two triangles that agree on its direction, every vertex one fan, no triangle twice or with
  /// a repeated vertex.
  bool manifold() const;
  /// closed() and manifold(), without zero-area triangles or unreferenced vertices: what soapfilm promises to write.
  bool watertight() const;
};

/// Time and memory are linear in the mesh: 1.4 million triangles take about half a second.
/// Throws ParameterError when a triangle names a vertex that does not exist.
TopologyReport check_topology(const Mesh& mesh);

/// One line for people: "closed, manifold, 1 component, genus 0", or what is wrong with it.
std::string summary(const TopologyReport& report);

}  // namespace soapfilm
