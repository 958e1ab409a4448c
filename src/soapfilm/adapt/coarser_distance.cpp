#include "soapfilm/adapt/coarser_distance.h"

#include <array>

#include "soapfilm/grid/trilinear.h"

namespace soapfilm {

namespace {

float value_at(const DistanceField& field, Vec3i v) {
  const int32_t n = field.grid.find(brick_of(v));
  return n >= 0 ? field.value.brick(static_cast<size_t>(n))[brick_offset(v.x & 7, v.y & 7, v.z & 7)]
                : field.missing_value(brick_of(v));
}

}  // namespace

float distance_at_finer(const DistanceField& coarse, Vec3i fine_vertex) {
  // Fine vertex v lies at (v - 1/2) / 2 on the coarser level: a quarter below or above one of its vertices.
  Vec3i first;
  Vec3f in_cell;
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = (fine_vertex[axis] - 1) >> 1;
    in_cell[axis] = fine_vertex[axis] % 2 == 0 ? 0.75f : 0.25f;
  }
  std::array<float, 8> corners;
  for (int k = 0; k < 8; ++k) corners[static_cast<size_t>(k)] = value_at(coarse, first + octant_of(k));
  return trilinear(corners, in_cell).value;
}

}  // namespace soapfilm
