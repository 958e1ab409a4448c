// A mesh in the course of being remeshed: which of its edges are features, how long its edges shall be.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/remesh/features.h"
#include "soapfilm/simplify/edited_mesh.h"

namespace soapfilm {

/// What a vertex may do: move on the surface, move along a chain, or stay.
struct Anchor {
  static constexpr uint32_t free = ~uint32_t{0}, fixed = free - 1;
  uint32_t chain = free;
  double at = 0;  ///< along the chain

  bool is_free() const { return chain == free; }
  bool is_fixed() const { return chain == fixed; }
};

/// Lengths are in the local frame.
struct WorkingMesh : EditedMesh {
  WorkingMesh(const Mesh& given, const Written& written_as, double edge)
      : EditedMesh(given, written_as), anchor(original.size()), size(original.size(), edge) {}

  /// Of the original, as which the mesh still is.
  void keep(Features found);

  Features features;                    ///< of the original
  std::vector<uint32_t> chain_of_edge;  ///< by half edge; none
  std::vector<Anchor> anchor;           ///< by vertex
  std::vector<double> size;             ///< by vertex: how long edges shall be there

  Vec3d from(uint32_t h) const { return position[mesh.from(h)]; }
  Vec3d to(uint32_t h) const { return position[mesh.to(h)]; }
  double length(uint32_t h) const { return norm(to(h) - from(h)); }
  double wanted(uint32_t a, uint32_t b) const { return std::min(size[a], size[b]); }
  double wanted(uint32_t h) const { return wanted(mesh.from(h), mesh.to(h)); }
  bool is_feature(uint32_t h) const { return chain_of_edge[h] != none; }
  /// Of each edge one half edge: of triangles that are there.
  bool leads(uint32_t h) const { return mesh.is_alive(h / 3) && (mesh.twin(h) == none || h < mesh.twin(h)); }

  /// Where along the chain the vertex is, which lies on it.
  double along(uint32_t chain, uint32_t vertex) const;
  template <class Visit>
  void for_neighbors(uint32_t vertex, Visit&& visit) const {
    mesh.for_fan(vertex, [&](uint32_t h) {
      visit(mesh.to(h));
      const uint32_t last = Connectivity::previous(h);
      if (mesh.twin(last) == none) visit(mesh.from(last));
    });
  }
  size_t valence(uint32_t vertex) const;
  /// Twice the areas of its triangles along their normals, summed.
  Vec3d normal(uint32_t vertex) const;

  /// No size is much larger than one near it.
  void grade_sizes();
};

/// Twice the area along the normal.
inline Vec3d area_normal(const std::array<Vec3d, 3>& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// Square of the sine of the smallest angle.
double squared_sharpness(const std::array<Vec3d, 3>& t);

}  // namespace soapfilm
