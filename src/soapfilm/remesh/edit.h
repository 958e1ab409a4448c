// One change of a mesh that is remeshed: is it allowed, and doing it.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/remesh/landmarks.h"
#include "soapfilm/remesh/working_mesh.h"
#include "soapfilm/simplify/quadric.h"
#include "soapfilm/simplify/thin_places.h"

namespace soapfilm {

/// Each change keeps components, genus and borders, turns no triangle over, makes no flat ones, and none that meet in
/// thin places. Each returns whether it was done.
class Edit {
 public:
  /// `distance`: the most that a change may take the surface away from a vertex that it removes.
  Edit(WorkingMesh& now, ThinPlaces& thin, double distance, Landmarks landmarks)
      : now_(now), thin_(thin), distance_(distance), landmarks_(std::move(landmarks)) {}

  /// At the middle of the edge, or of its stretch of the chain.
  bool split(uint32_t h);
  /// Into the end `kept`, without making edges longer than `longest` times what is wanted.
  bool collapse(uint32_t h, uint32_t kept, double longest);
  bool flip(uint32_t h);
  bool move(uint32_t vertex, Vec3d place);

  /// While quadrics are given, by vertex, collapses keep to them instead of to the vertices that they remove.
  void use_quadrics(std::vector<Quadric>* quadrics) { quadrics_ = quadrics; }

 private:
  static constexpr uint32_t none = WorkingMesh::none;

  void begin();
  void replace(uint32_t triangle, const std::array<Vec3d, 3>& by);
  bool keeps_facing(Vec3d around, double sharpest) const;
  bool folds() const;
  bool are_folded(const std::vector<std::array<Vec3d, 3>>& triangles) const;
  bool meets_others();
  bool may_slide(uint32_t h, uint32_t gone, uint32_t kept) const;
  bool may_merge_corners(uint32_t h, uint32_t gone, uint32_t kept) const;
  bool keeps_topology(uint32_t h) const;
  bool keeps_lengths(uint32_t kept, double longest) const;
  bool keeps_distance(uint32_t gone, uint32_t kept) const;
  void take_out();
  void put_back();

  WorkingMesh& now_;
  ThinPlaces& thin_;
  double distance_;
  Landmarks landmarks_;
  std::vector<Quadric>* quadrics_ = nullptr;
  std::vector<uint32_t> old_;                // triangles that change or go
  std::vector<std::array<Vec3d, 3>> was_;    // those that `fresh_` replace, as they are
  std::vector<std::array<Vec3d, 3>> fresh_;  // as they will be
  std::vector<uint32_t> changed_;            // their numbers afterwards, for the lists
  std::vector<uint32_t> ring_;               // neighbors of the vertex that goes
  bool at_thin_ = false;
};

}  // namespace soapfilm
