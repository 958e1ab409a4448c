#include "soapfilm/simplify/carry_over.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

constexpr size_t vertices_per_task = 1024;

float value_of(const Column& column, const Blend& blend) {
  const float nearest = column.values[blend.vertex[0]];
  if (column.is_label) return nearest;
  double sum = 0;
  for (size_t k = 0; k < 3; ++k)
    if (blend.weight[k] > 0) sum += blend.weight[k] * static_cast<double>(column.values[blend.vertex[k]]);
  return std::isnan(sum) ? nearest : static_cast<float>(sum);
}

Rgb8 color_of(const std::vector<Rgb8>& colors, const Blend& blend) {
  Rgb8 color{};
  for (size_t channel = 0; channel < 3; ++channel) {
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) sum += blend.weight[k] * colors[blend.vertex[k]][channel];
    color[channel] = static_cast<uint8_t>(std::clamp(std::lround(sum), 0L, 255L));
  }
  return color;
}

Vec3f normal_of(const std::vector<Vec3f>& normals, const Blend& blend) {
  Vec3d sum;
  for (size_t k = 0; k < 3; ++k) sum += Vec3d(normals[blend.vertex[k]]) * blend.weight[k];
  return Vec3f(normalized(sum));
}

}  // namespace

Blend blend_at(Vec3d p, const Triangle& vertex, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d n = cross(b - a, c - a);
  const double area = dot(n, n);
  std::array<double, 3> weight{1, 0, 0};
  if (area > 0)
    weight = {dot(n, cross(b - p, c - p)) / area, dot(n, cross(c - p, a - p)) / area,
              dot(n, cross(a - p, b - p)) / area};
  double sum = 0;
  for (double& w : weight) sum += w = std::max(w, 0.0);
  std::array<size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](size_t i, size_t j) { return weight[i] > weight[j]; });
  Blend blend{};
  for (size_t k = 0; k < 3; ++k) {
    blend.vertex[k] = vertex[order[k]];
    blend.weight[k] = weight[order[k]] / sum;
  }
  return blend;
}

void append_blended(Mesh& to, const Mesh& from, const std::vector<Blend>& blends) {
  for (const Blend& blend : blends) {
    if (!from.normals.empty()) to.normals.push_back(normal_of(from.normals, blend));
    if (!from.colors.empty()) to.colors.push_back(color_of(from.colors, blend));
  }
  for (const Column& column : from.attributes) {
    to.attributes.push_back({column.name, {}, column.is_label});
    to.attributes.back().values.reserve(blends.size());
    for (const Blend& blend : blends) to.attributes.back().values.push_back(value_of(column, blend));
  }
}

Mesh carry_over(const Mesh& mesh, const CollapsedMesh& now, const FaceGrid& grid, double distance,
                const Context& context) {
  std::vector<uint8_t> was_used(mesh.vertices.size());
  for (const Triangle& t : now.was.all_corners())
    for (const uint32_t v : t) was_used[v] = 1;
  std::vector<uint32_t> kept, number(mesh.vertices.size());
  for (uint32_t v = 0; v < number.size(); ++v) {
    if (was_used[v] && !now.mesh.is_used(v)) continue;
    number[v] = static_cast<uint32_t>(kept.size());
    kept.push_back(v);
  }
  std::vector<Blend> blends(kept.size());
  Mesh result;
  result.vertices.resize(kept.size());
  parallel_for(context, kept.size(), vertices_per_task, [&](size_t i) {
    const uint32_t v = kept[i];
    const Vec3d p = now.position[v];
    result.vertices[i] = now.written.world(p);
    blends[i] = {{v, v, v}, {1, 0, 0}};
    if (p == now.original[v]) return;
    const uint32_t f = grid.nearest(p, distance);
    if (f != CellTable::none)
      blends[i] = blend_at(p, now.was.corners(f), grid.corner(f, 0), grid.corner(f, 1), grid.corner(f, 2));
  });
  for (uint32_t t = 0; t < now.mesh.triangles(); ++t) {
    if (!now.mesh.is_alive(t)) continue;
    const Triangle& v = now.mesh.corners(t);
    result.triangles.push_back({number[v[0]], number[v[1]], number[v[2]]});
  }
  append_blended(result, mesh, blends);
  return result;
}

}  // namespace soapfilm
