#include "soapfilm/finish/rays.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <unordered_map>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/scanner_places.h"
#include "soapfilm/core/some_by_place.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

namespace {

constexpr size_t most_rays = 200000;
constexpr double first_counted = 3;              // voxels from the sample
constexpr double least_cube = 2, most_cube = 8;  // voxels: edge of the cubes in which triangles are looked up
constexpr double cube_of_edges = 10;             // the same, in edges of these

/// 21 bits for each axis.
uint64_t key_of(Vec3i c) {
  const auto bits = [](int32_t v) { return static_cast<uint64_t>(static_cast<uint32_t>(v)) & 0x1FFFFF; };
  return bits(c.x) | bits(c.y) << 21 | bits(c.z) << 42;
}

using Corners = std::array<Vec3d, 3>;

/// Moeller and Trumbore 1997: length along the unit `way` at which the ray crosses the triangle, or -1.
double crossing(const Corners& c, Vec3d from, Vec3d way) {
  const Vec3d ab = c[1] - c[0], ac = c[2] - c[0], p = cross(way, ac);
  const double det = dot(ab, p);
  if (det == 0) return -1;
  const Vec3d t = from - c[0];
  const double u = dot(t, p) / det;
  if (!(u >= 0 && u <= 1)) return -1;
  const Vec3d q = cross(t, ab);
  const double v = dot(way, q) / det;
  return v >= 0 && u + v <= 1 ? dot(ac, q) / det : -1;
}

/// The made-up triangles by the cubes that their boxes touch.
class MadeUp {
 public:
  MadeUp(const Mesh& mesh, const std::vector<double>& level, const Lattice& lattice) {
    double edges = 0;
    for (const Triangle& t : mesh.triangles) {
      if (!(level[t[0]] > 1 && level[t[1]] > 1 && level[t[2]] > 1)) continue;
      Corners& corners = corners_.emplace_back();
      for (size_t k = 0; k < 3; ++k) box_.extend(corners[k] = lattice.to_lattice(mesh.vertices[t[k]]));
      edges += norm(corners[1] - corners[0]);
      vertex_.push_back(t[0]);
    }
    if (empty()) return;
    cube_ = std::clamp(cube_of_edges * edges / static_cast<double>(corners_.size()), least_cube, most_cube);
    for (size_t index = 0; index < corners_.size(); ++index) {
      Box3d box;
      for (const Vec3d& corner : corners_[index]) box.extend(corner);
      const Vec3d rounding{1e-6, 1e-6, 1e-6};
      const Vec3i lo = cube_of(box.lo - rounding), hi = cube_of(box.hi + rounding);
      for (int32_t z = lo.z; z <= hi.z; ++z)
        for (int32_t y = lo.y; y <= hi.y; ++y)
          for (int32_t x = lo.x; x <= hi.x; ++x) cubes_[key_of({x, y, z})].push_back(static_cast<uint32_t>(index));
    }
  }

  /// visit(vertex) for each triangle that the ray crosses. A triangle counts in the cube in which it is crossed.
  template <class Visit>
  void for_each_crossed(const Ray& ray, Visit&& visit) const {
    const Vec3d from(ray.sample), to(ray.scanner);
    const double length = norm(to - from);
    if (!(length > first_counted) || !std::isfinite(length)) return;
    const Vec3d way = (to - from) / length;
    double begin = first_counted, end = length;
    clip(from, way, begin, end);
    if (!(begin < end)) return;
    const Vec3d start = from + way * begin;
    Vec3i at = cube_of(start);
    std::array<double, 3> next{}, step{};  // lengths along the ray: of the next wall, and from wall to wall
    std::array<int, 3> side{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      side[k] = way[axis] > 0 ? 1 : way[axis] < 0 ? -1 : 0;
      step[k] = side[k] == 0 ? 2 * length : cube_ / std::abs(way[axis]);
      const double wall = cube_ * (at[axis] + (side[k] > 0));
      next[k] = side[k] == 0 ? 2 * length : begin + (wall - start[axis]) / way[axis];
    }
    for (double here = begin; here < end;) {
      const size_t axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
      if (const auto found = cubes_.find(key_of(at)); found != cubes_.end())
        for (const uint32_t i : found->second)
          if (const double there = crossing(corners_[i], from, way);
              there > first_counted && there < length && cube_of(from + way * there) == at)
            visit(vertex_[i]);
      here = next[axis];
      at[static_cast<int>(axis)] += side[axis];
      next[axis] += step[axis];
    }
  }

  bool empty() const { return corners_.empty(); }

 private:
  /// The part of a ray inside the box of all triangles, and a voxel around it: a scanner may be very far away.
  void clip(Vec3d from, Vec3d way, double& begin, double& end) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = box_.lo[axis] - 1 - from[axis], hi = box_.hi[axis] + 1 - from[axis];
      if (way[axis] == 0) {
        if (lo > 0 || hi < 0) end = begin;
        continue;
      }
      begin = std::max(begin, std::min(lo / way[axis], hi / way[axis]));
      end = std::min(end, std::max(lo / way[axis], hi / way[axis]));
    }
  }

  Vec3i cube_of(Vec3d p) const {
    constexpr double most = 1e9;
    const auto at = [&](double v) { return static_cast<int32_t>(std::clamp(std::floor(v / cube_), -most, most)); };
    return {at(p.x), at(p.y), at(p.z)};
  }

  Box3d box_;
  double cube_ = most_cube;
  std::vector<Corners> corners_;
  std::vector<uint32_t> vertex_;
  std::unordered_map<uint64_t, std::vector<uint32_t>> cubes_;
};

}  // namespace

std::vector<Ray> some_rays(const PointCloud& cloud, const std::optional<Vec3d>& sensor, const Lattice& lattice,
                           const Context& context) {
  std::vector<Ray> rays;
  for (const uint32_t i : some_by_place(cloud.box(context), cloud.size(), most_rays, context,
                                        [&](size_t k) { return cloud.positions[k]; }))
    if (const auto place = scanner_of(cloud, i, sensor))
      rays.push_back({Vec3f(lattice.to_lattice(cloud.positions[i])), Vec3f(lattice.to_lattice(*place))});
  return rays;
}

std::vector<uint32_t> count_crossings(const Mesh& mesh, const std::vector<double>& level, const std::vector<Ray>& rays,
                                      const Lattice& lattice, const Context& context) {
  if (rays.empty()) return {};
  const MadeUp made_up(mesh, level, lattice);
  if (made_up.empty()) return {};
  std::vector<std::atomic<uint32_t>> counts(mesh.vertices.size());  // sums of ones: no order matters
  parallel_for(context, rays.size(), 1024, [&](size_t k) {
    made_up.for_each_crossed(rays[k], [&](uint32_t v) { counts[v].fetch_add(1, std::memory_order_relaxed); });
  });
  std::vector<uint32_t> crossed(counts.size());
  for (size_t v = 0; v < counts.size(); ++v) crossed[v] = counts[v].load(std::memory_order_relaxed);
  return crossed;
}

}  // namespace soapfilm
