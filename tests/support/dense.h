// Levels expanded to every vertex of their box, and the energy's formulas written as simply as possible: the reference
// of the sparse code. All in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/field/divergence.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm::test {

/// Values at all vertices of a box that starts at (0, 0, 0), x fastest; `outside` beyond it.
template <class T>
class Dense {
 public:
  Dense() = default;
  explicit Dense(Vec3i size, T fill = T{})
      : size_(size), values_(static_cast<size_t>(size.x) * size.y * size.z, fill) {}

  Vec3i size() const { return size_; }
  bool contains(Vec3i v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size_.x && v.y < size_.y && v.z < size_.z;
  }
  T& operator[](Vec3i v) { return values_[index(v)]; }
  const T& operator[](Vec3i v) const { return values_[index(v)]; }
  T get(Vec3i v, T outside = T{}) const { return contains(v) ? values_[index(v)] : outside; }
  const std::vector<T>& values() const { return values_; }

  template <class Visit>
  void for_each(Visit&& visit) const {
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) visit(Vec3i{x, y, z});
  }

 private:
  size_t index(Vec3i v) const {
    return (static_cast<size_t>(v.z) * static_cast<size_t>(size_.y) + static_cast<size_t>(v.y)) *
               static_cast<size_t>(size_.x) +
           static_cast<size_t>(v.x);
  }
  Vec3i size_;
  std::vector<T> values_;
};

using DenseVectors = std::array<Dense<double>, 3>;

inline Vec3i along(int axis) { return {axis == 0, axis == 1, axis == 2}; }

/// Calls visit(lattice vertex, position in the brick) for the 512 vertices of a brick.
template <class Visit>
void for_each_vertex(Vec3i brick, Visit&& visit) {
  for (int i = 0; i < brick_volume; ++i) visit(brick * brick_side + vertex_in_brick(i), i);
}

/// u on the whole box: that of the band, elsewhere from `inside`. With a threshold: 1 where u exceeds it.
inline Dense<double> dense_u(const Level& level, std::optional<float> threshold = {}) {
  Dense<double> u(level.box.bricks * brick_side);
  BrickRange::whole(level.box.bricks).for_each([&](Vec3i b) {
    if (level.missing_u(level.grid.find(b), b) > 0) for_each_vertex(b, [&](Vec3i v, int) { u[v] = 1; });
  });
  for (size_t b = 0; b < level.grid.size(); ++b)
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      const float value = level.u.brick(b)[i];
      u[v] = threshold ? value > *threshold : static_cast<double>(value);
    });
  return u;
}

inline Dense<double> dense_f(const Level& level) {
  Dense<double> f(level.box.bricks * brick_side);
  for (size_t b = 0; b < level.grid.size(); ++b)
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) { f[v] = level.data(b)[i]; });
  return f;
}

inline Dense<double> dense_field(const SupportField& field, const LevelBox& box) {
  Dense<double> f(box.bricks * brick_side);
  for (size_t b = 0; b < field.grid.size(); ++b)
    for_each_vertex(field.grid.coord(b), [&](Vec3i v, int i) { f[v] = field.f.brick(b)[i]; });
  return f;
}

/// Copies the band's p into `p`.
inline void insert_band(const Level& level, DenseVectors& p) {
  for (size_t b = 0; b < level.grid.size(); ++b)
    for (int axis = 0; axis < 3; ++axis)
      for_each_vertex(level.grid.coord(b),
                      [&](Vec3i v, int i) { p[static_cast<size_t>(axis)][v] = level.p.brick(b, axis)[i]; });
}

/// Calls visit(vertex below the face, flux) for the faces between the band and inactive bricks below it.
template <class Visit>
void for_each_low_rim_face(const Level& level, size_t brick, int axis, Visit&& visit) {
  const float* plane = level.rim.plane(brick, axis);
  if (!plane) return;
  const Vec3i first = level.grid.first_vertex(brick) - along(axis);
  for (int k = 0; k < brick_area; ++k) {
    Vec3i v = first;
    v[axis == 0 ? 1 : 0] += k % brick_side;
    v[axis == 2 ? 1 : 2] += k / brick_side;
    visit(v, plane[k]);
  }
}

/// p of the band and of its boundary, zero elsewhere.
inline DenseVectors dense_p(const Level& level) {
  const Dense<double> zero(level.box.bricks * brick_side);
  DenseVectors p{zero, zero, zero};
  insert_band(level, p);
  for (size_t b = 0; b < level.grid.size(); ++b)
    for (int axis = 0; axis < 3; ++axis)
      for_each_low_rim_face(level, b, axis, [&](Vec3i v, float flux) { p[static_cast<size_t>(axis)][v] = flux; });
  return p;
}

inline Vec3d gradient_at(const Dense<double>& u, Vec3i v) {
  const double here = u[v];
  return {u.get(v + along(0)) - here, u.get(v + along(1)) - here, u.get(v + along(2)) - here};
}

/// The same on a level's box: if that is open only between free vertices.
inline Vec3d gradient_at(const Dense<double>& u, Vec3i v, const LevelBox& box) {
  Vec3d g = gradient_at(u, v);
  for (int axis = 0; axis < 3; ++axis)
    if (box.open && !(box.is_free(v) && box.is_free(v + along(axis)))) g[axis] = 0;
  return g;
}

/// The largest flux through faces that an open box does not have.
inline double flux_beyond_border(const DenseVectors& p, const LevelBox& box) {
  double most = 0;
  p[0].for_each([&](Vec3i v) {
    for (int axis = 0; axis < 3; ++axis)
      if (!(box.is_free(v) && box.is_free(v + along(axis))))
        most = std::max(most, std::abs(p[static_cast<size_t>(axis)][v]));
  });
  return most;
}

inline Vec3d vector_at(const DenseVectors& p, Vec3i v) { return {p[0][v], p[1][v], p[2][v]}; }

inline double adjoint_at(const DenseVectors& p, Vec3i v) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& component = p[static_cast<size_t>(axis)];
    sum += component.get(v - along(axis)) - component[v];
  }
  return sum;
}

/// |g| of the gradient.
inline double length(Vec3d g, Norm norm_kind = Norm::isotropic) {
  return norm_kind == Norm::isotropic ? norm(g) : std::abs(g.x) + std::abs(g.y) + std::abs(g.z);
}
/// |p| of the dual: feasible where it is at most lambda.
inline double dual_length(Vec3d p, Norm norm_kind = Norm::isotropic) {
  return norm_kind == Norm::isotropic ? norm(p) : std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

inline double total_variation(const Dense<double>& u, Norm norm_kind = Norm::isotropic) {
  double sum = 0;
  u.for_each([&](Vec3i v) { sum += length(gradient_at(u, v), norm_kind); });
  return sum;
}

inline double total_variation(const Dense<double>& u, Norm norm_kind, const LevelBox& box) {
  double sum = 0;
  u.for_each([&](Vec3i v) { sum += length(gradient_at(u, v, box), norm_kind); });
  return sum;
}

inline double inner_product(const Dense<double>& a, const Dense<double>& b) {
  double sum = 0;
  a.for_each([&](Vec3i v) { sum += a[v] * b[v]; });
  return sum;
}

/// D(p) = sum of min(0, grad^T p - f) over the vertices for which `counts` is true.
template <class Counts>
double dual_energy(const DenseVectors& p, const Dense<double>& f, Counts&& counts) {
  double sum = 0;
  f.for_each([&](Vec3i v) {
    if (counts(v)) sum += std::min(0.0, adjoint_at(p, v) - f[v]);
  });
  return sum;
}

/// Thresholded u on the whole box.
inline Dense<uint8_t> dense_labels(const Level& level, float threshold = 0.5f) {
  Dense<uint8_t> labels(level.box.bricks * brick_side);
  const Dense<double> u = dense_u(level, threshold);
  u.for_each([&](Vec3i v) { labels[v] = level.box.is_free(v) && u[v] > 0.5; });
  return labels;
}

/// The same of labels.
inline Dense<uint8_t> dense_labels(const Labels& from) {
  Dense<uint8_t> labels(from.box.bricks * brick_side);
  labels.for_each([&](Vec3i v) { labels[v] = from.box.is_free(v) && from.test(v); });
  return labels;
}

inline size_t count_inside(const Dense<uint8_t>& labels) {
  return static_cast<size_t>(std::count(labels.values().begin(), labels.values().end(), 1));
}

inline size_t count_differences(const Dense<uint8_t>& a, const Dense<uint8_t>& b) {
  size_t count = 0;
  a.for_each([&](Vec3i v) { count += a[v] != b.get(v); });
  return count;
}

}  // namespace soapfilm::test
