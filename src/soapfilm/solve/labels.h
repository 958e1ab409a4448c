// On which side of the surface each vertex is, one bit per vertex: all that the stages after the certificate need.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/solve/domain.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// The labels of a domain, in its bricks and between them. Both must outlive it.
class LabelView {
 public:
  LabelView(const Domain& domain, const std::vector<BrickBits>& bits) : domain_(domain), bits_(bits) {}

  /// Those of a brick; `n` is the result of BrickGrid::find.
  const BrickBits& of(int32_t n, Vec3i brick) const;
  /// The same, but beyond an open border as at the nearest vertex in front of it.
  BrickBits continued(int32_t n, Vec3i brick) const;
  /// The vertices of brick b of the grid that have one of their six neighbors on the other side; none across an open
  /// border.
  BrickBits interface(size_t b) const;
  std::vector<BrickBits> interfaces(const Context& context) const;  ///< of all bricks
  /// Vertices of brick b whose face to the neighbor along an axis, up (step 1) or down (-1), belongs to the problem:
  /// all but those at an open border, or at the end of the places that the domain covers.
  BrickBits joined_to(size_t b, int axis, int step) const;

 private:
  const Domain& domain_;
  const std::vector<BrickBits>& bits_;
};

/// Inside and outside: a binary indicator, without the numbers that it came from.
struct Labels : Domain {
  std::vector<BrickBits> bits;  ///< of each brick, set where the vertex is inside

  LabelView view() const { return {*this, bits}; }
  const BrickBits& of(int32_t n, Vec3i brick) const { return view().of(n, brick); }
  const BrickBits& of(Vec3i brick) const { return of(grid.find(brick), brick); }
  bool test(Vec3i vertex) const { return of(brick_of(vertex)).test(vertex.x & 7, vertex.y & 7, vertex.z & 7); }
};

/// u > threshold in each brick of the level's grid.
std::vector<BrickBits> bits_above(const Level& level, float threshold, const Context& context);
/// u > threshold.
Labels labels_of(const Level& level, float threshold, const Context& context);
/// The same; frees the level.
Labels labels_of(Level&& level, float threshold, const Context& context);

/// Vertices of the whole domain that are inside.
size_t count_inside(const Domain& domain, const std::vector<BrickBits>& bits);
/// Pairs of neighboring vertices on different sides, none across an open border: about as many as the surface's mesh
/// has vertices.
size_t count_faces(const Labels& labels, const Context& context);

}  // namespace soapfilm
