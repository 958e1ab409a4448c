// Which triangles of a mesh are neighbors.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// The edges of a manifold mesh. Half edge 3 t + k runs from corner k of triangle t to the next corner; its twin runs
/// back, in the neighboring triangle. Edges of the boundary have one half and no twin.
class HalfEdges {
 public:
  static constexpr uint32_t none = ~uint32_t{0};

  /// `mesh` must outlive it; it needs fewer than 2^32 half edges, and no vertex where it touches itself.
  explicit HalfEdges(Mesh& mesh);
  /// The same; ranks share the search for twins.
  HalfEdges(Mesh& mesh, const Context& context);

  const Mesh& mesh() const { return mesh_; }
  uint32_t size() const { return static_cast<uint32_t>(twin_.size()); }
  uint32_t twin(uint32_t h) const { return twin_[h]; }
  static uint32_t next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static uint32_t previous(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  uint32_t from(uint32_t h) const { return mesh_.triangles[h / 3][h % 3]; }
  uint32_t to(uint32_t h) const { return from(next(h)); }
  uint32_t opposite(uint32_t h) const { return from(previous(h)); }  ///< the triangle's third corner
  bool on_boundary(uint32_t h) const { return twin_[h] == none; }
  /// True for one half of every edge that has two.
  bool upward(uint32_t h) const { return from(h) < to(h); }

  /// Is there an edge between the vertex where `h` starts and `vertex`?
  bool joins(uint32_t h, uint32_t vertex) const;

  /// Replaces an edge, not of the boundary, by the other diagonal of its two triangles, which keep their numbers.
  void flip(uint32_t h);

 private:
  /// Finds the twins of at least some triangles' half edges.
  void link_all(ItemRange wanted);
  void link(uint32_t h, uint32_t other) {
    if (h != none) twin_[h] = other;
    if (other != none) twin_[other] = h;
  }

  Mesh& mesh_;
  std::vector<uint32_t> twin_;
};

}  // namespace soapfilm
