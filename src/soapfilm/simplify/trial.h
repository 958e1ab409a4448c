// One collapse: is it allowed, and doing it.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/simplify/collapsed_mesh.h"
#include "soapfilm/simplify/face_grid.h"
#include "soapfilm/simplify/near_original.h"
#include "soapfilm/simplify/placement.h"
#include "soapfilm/simplify/proof.h"
#include "soapfilm/simplify/thin_places.h"

namespace soapfilm {

/// A box of space in which one thread works. What lies in it or on its faces changes only there.
struct Tile {
  Vec3d lo, hi;
  bool holds(Vec3d p) const { return p.x > lo.x && p.y > lo.y && p.z > lo.z && p.x < hi.x && p.y < hi.y && p.z < hi.z; }
};

/// What a run of collapses shares.
struct CollapseRun {
  CollapsedMesh& now;
  const FaceGrid& grid;
  ThinPlaces& thin;
  double distance;  ///< local frame
  SimplifyChecks checks;
  bool proves;  ///< each collapse, instead of testing it at samples alone
};

/// Tries collapses one after the other. Distances are tested at samples: the original's vertices against the new
/// triangles, points on the new edges against the original. (What they miss is found by prove().)
class Trial {
 public:
  enum class Outcome { done, refused, beyond_tile };

  Trial(CollapseRun& run, const Tile& tile) : run_(run), now_(run.now), tile_(tile), near_(run.now, run.grid) {}

  /// Of the edge between two vertices. Where it is done the log gets it; `kept()` is the vertex that is left.
  Outcome attempt(uint32_t a, uint32_t b, CollapseLog& log);
  uint32_t kept() const { return kept_; }

 private:
  static constexpr uint32_t none = CollapsedMesh::none;

  struct NewFace {
    uint32_t triangle;
    std::array<Vec3d, 3> corner;
    Vec3d normal;  ///< of no certain length
    double squared_normal;
  };
  struct Owned {
    uint32_t vertex, triangle;
    std::array<Vec3d, 3> corner;  ///< of that triangle as it will be
  };

  bool find_edge(uint32_t a, uint32_t b);
  bool gather_star();
  bool gather_fan(uint32_t vertex);
  bool is_removed(uint32_t triangle) const { return triangle == removed_[0] || triangle == removed_[1]; }
  bool keeps_topology() const;
  bool choose_place();
  bool keeps_shape();
  bool border_is_near() const;
  bool old_is_near();
  bool assign(uint32_t vertex, size_t likely);
  bool assign_beyond(uint32_t vertex);
  void gather_ring(bool only_in_tile);
  bool is_sampled(Vec3d p);
  bool new_is_near();
  bool is_proved();
  bool faces_are_near();
  bool covers_face(uint32_t face, std::vector<std::array<Vec3d, 3>> triangles) const;
  bool meets_others();
  void commit(CollapseLog& log);

  CollapseRun& run_;
  CollapsedMesh& now_;
  Tile tile_;
  uint32_t edge_ = none, kept_ = none, gone_ = none;
  std::array<uint32_t, 2> removed_{none, none};
  size_t star_of_kept_ = 0;          // how many of star_ come from the fan of `kept`
  std::vector<uint32_t> star_;       // half edges from either end, of triangles that stay
  std::vector<uint32_t> link_[2];    // neighbors of kept, of gone
  std::vector<StarCorners> around_;  // all triangles as they are
  std::vector<NewFace> faces_;       // star_ as it will be
  std::vector<Owned> owned_;
  std::vector<uint32_t> ring_;                    // triangles around the star; empty: not gathered yet
  std::vector<std::array<uint32_t, 2>> checked_;  // original faces, and the index in owned_ of a corner
  std::vector<ThinPlaces::NewTriangle> new_triangles_;
  std::vector<uint32_t> replaced_;
  bool at_thin_ = false;
  bool is_close_call_ = false;  // one of the samples is not well within the distance
  Vec3d place_;
  NearOriginal near_;
};

}  // namespace soapfilm
