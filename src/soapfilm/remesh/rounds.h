// Rounds of changes towards edges of equal length (Botsch and Kobbelt 2004, A remeshing approach to multiresolution
// modeling).
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/remesh/edit.h"
#include "soapfilm/remesh/working_mesh.h"
#include "soapfilm/simplify/face_grid.h"

namespace soapfilm {

class Rounds {
 public:
  /// `distance`: local frame; the most that one change may take the surface away. `landmarks`: what all of them
  /// together must stay near.
  Rounds(WorkingMesh& now, const FaceGrid& grid, ThinPlaces& thin, double distance, Landmarks landmarks,
         const Context& context)
      : now_(now), grid_(grid), thin_(thin), edit_(now, thin, distance, std::move(landmarks)), context_(context) {}

  /// From the original to edges of about the length that is wanted.
  void begin();
  /// Splits, collapses, flips and smooths; `count` times. Then angles are improved.
  void improve(int count);

 private:
  void split_long();
  void collapse_short(double below);
  void collapse_gradually();
  template <class Better>
  void flip(Better&& better);
  void flip_to_valence();
  void flip_to_angles();
  void smooth();
  bool move_towards(uint32_t vertex, Vec3d place);
  void mend();
  bool mend_triangle(uint32_t triangle);
  bool mend_vertex(uint32_t vertex);
  double sharpest_of_fan(uint32_t vertex, Vec3d place) const;
  std::optional<Vec3d> smoothed(uint32_t vertex) const;
  std::optional<Vec3d> smoothed_along(uint32_t vertex) const;
  std::optional<Vec3d> projected(Vec3d p, Vec3d normal, double size) const;

  WorkingMesh& now_;
  const FaceGrid& grid_;
  ThinPlaces& thin_;
  Edit edit_;
  const Context& context_;
};

}  // namespace soapfilm
