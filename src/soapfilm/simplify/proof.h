// The proof that old and new surface are within a distance of each other, and that no triangles intersect.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/simplify/collapsed_mesh.h"
#include "soapfilm/simplify/face_grid.h"
#include "soapfilm/simplify/near_original.h"

namespace soapfilm {

/// What is checked: all of it, except in tests of what finds faults.
struct SimplifyChecks {
  bool distance = true, intersections = true;
};

/// That every point of the original is within a distance of the mesh as it is now, and the reverse; that no two
/// triangles intersect which did not in the original. Only what changed since the last call of holds() is examined.
class Proof {
 public:
  /// `distance`: local frame.
  Proof(CollapsedMesh& now, const FaceGrid& grid, double distance, const SimplifyChecks& checks,
        const Context& context);

  /// If not, the last collapses at places that fail are taken back. Ends after a finite number of calls: the original
  /// is within any distance of itself.
  bool holds();

  /// By vertex: whether one of its triangles was changed when collapses were taken back.
  const std::vector<uint8_t>& changed_vertices() const { return changed_vertices_; }
  /// At most `distance`, local frame; once it holds.
  double proved() const { return proved_; }

 private:
  static constexpr uint32_t none = CollapsedMesh::none;
  struct Failures;

  void mark_changed();
  std::vector<uint32_t> failures();
  bool is_as_it_was(uint32_t face) const { return now_.mesh.is_alive(face) && !now_.is_changed(face); }
  bool face_is_near(uint32_t face, double& most) const;
  std::vector<uint32_t> owners_of(const Triangle& face) const;
  std::vector<uint32_t> triangles_around(const Triangle& face) const;
  uint32_t blamed(uint32_t face) const;
  void take_back(std::vector<uint32_t> failed);

  CollapsedMesh& now_;
  const FaceGrid& grid_;
  double distance_;
  SimplifyChecks checks_;
  const Context& context_;
  int calls_ = 0;
  uint32_t first_new_stamp_ = 1;
  double proved_ = 0;
  std::vector<uint8_t> open_, near_open_;  // by triangle: to be examined; around those
  std::vector<uint32_t> touched_;          // when collapses were taken back
  std::vector<uint8_t> changed_vertices_;
};

}  // namespace soapfilm
