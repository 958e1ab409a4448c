// A mesh in the course of being simplified, beside the original: what collapses change, and how they are taken back.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/mesh.h"
#include "soapfilm/simplify/edited_mesh.h"
#include "soapfilm/simplify/quadric.h"

namespace soapfilm {

/// The collapses of one tile. Their numbers, counted from `base`, are in no other log.
struct CollapseLog {
  struct Collapse {
    uint32_t half_edge, kept;
    Vec3d place;    ///< of `kept`, before
    size_t stamps;  ///< where its part of `before` begins
    bool undone = false;
  };
  struct Stamp {
    uint32_t triangle, before;
  };
  uint32_t base = 0;
  std::vector<Collapse> collapses;
  std::vector<Stamp> before;  ///< the stamps of the triangles that a collapse changes, from before it
};

/// Each original vertex is owned by a triangle that is near it; each
/// triangle has the number of the last collapse that changed it as a stamp, 0: none.
struct CollapsedMesh : EditedMesh {
  /// Throws ParameterError where the mesh is no 2-manifold.
  CollapsedMesh(const Mesh& mesh, const Written& written_as);

  std::vector<Quadric> quadric;                   ///< by vertex
  std::vector<uint32_t> version;                  ///< by vertex: changes with its place
  std::vector<uint8_t> fixed;                     ///< by vertex of a border: stays in place; empty: none has to
  std::vector<uint32_t> border;                   ///< by original border vertex: the next one; else none
  std::vector<uint32_t> stamp;                    ///< by triangle
  std::vector<uint32_t> first_owned, next_owned;  ///< lists of original vertices, by triangle
  std::vector<uint32_t> owner;                    ///< the triangle in whose list an original vertex is
  std::vector<CollapseLog> logs;                  ///< bases ascend
  uint32_t next_stamp = 1;

  bool is_fixed(uint32_t vertex) const { return !fixed.empty() && fixed[vertex] != 0; }
  bool is_changed(uint32_t triangle) const { return stamp[triangle] != 0; }
  void own(uint32_t triangle, uint32_t vertex) {
    next_owned[vertex] = first_owned[triangle];
    first_owned[triangle] = vertex;
    owner[vertex] = triangle;
  }

  /// Takes back the collapse of that number and, before it, all later ones that depend on it. Appends the triangles
  /// that are changed by it to `touched`.
  void undo(uint32_t number, std::vector<uint32_t>& touched);

  bool is_done(uint32_t number);

 private:
  CollapseLog& log_of(uint32_t number);
  void undo_one(const CollapseLog& log, size_t index, std::vector<uint32_t>& touched);
};

}  // namespace soapfilm
