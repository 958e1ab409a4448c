#include "tools/mesh/self_intersection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/triangle_pair.h"
#include "soapfilm/error.h"
#include "tools/mesh/embree_scene.h"

namespace soapfilm {

namespace {

constexpr size_t triangles_per_task = 1024;
constexpr double lattice_steps = 0x1p38;  // along the longest side

/// The mesh on the integer lattice, in a tree of boxes. Embree works in float, on boxes widened for its rounding.
class PairSearch {
 public:
  PairSearch(const Mesh& mesh, const Context& context) {
    Box3d box;
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      if (!is_finite(mesh.vertices[i])) throw ParameterError(fmt::format("vertex {} is not finite", i));
      box.extend(mesh.vertices[i]);
    }
    const double steps = box.longest() > 0.0 ? lattice_steps / box.longest() : 0.0;
    std::vector<LatticePoint> points;
    for (const Vec3d& v : mesh.vertices) {
      const Vec3d p = (v - box.center()) * steps;
      points.push_back({std::llround(p.x), std::llround(p.y), std::llround(p.z)});
    }
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle& t = mesh.triangles[i];
      const uint32_t highest = std::max({t[0], t[1], t[2]});
      if (highest >= points.size())
        throw ParameterError(fmt::format("triangle {} names vertex {}, must be < {}", i, highest, points.size()));
      const LatticeTriangle corners{points[t[0]], points[t[1]], points[t[2]]};
      if (!is_flat(corners)) triangles_.push_back(corners);
    }
    if (!triangles_.empty()) scene_.build(this, triangles_.size(), give_bounds, judge, context);
  }

  size_t size() const { return triangles_.size(); }

  /// Number of triangles after the given one, in the list's order, that it meets.
  size_t meeting(size_t index) const {
    const auto [lo, hi] = bounds(triangles_[index]);
    const Vec3d center = (lo + hi) * 0.5;
    Visit visit{this, static_cast<unsigned>(index), 0};
    RTCPointQuery query{};
    query.x = static_cast<float>(center.x);
    query.y = static_cast<float>(center.y);
    query.z = static_cast<float>(center.z);
    query.radius = static_cast<float>(0.5 * norm(hi - lo) + margin);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &query, &context, nullptr, &visit);
    return visit.met;
  }

 private:
  static constexpr double margin = 1e-6;  // in the tree's frame [-0.5, 0.5]: far above float's rounding there

  struct Visit {
    const PairSearch* self;
    unsigned triangle;
    size_t met;
  };

  static Box3d bounds(const LatticeTriangle& t) {
    Box3d box;
    for (const LatticePoint& p : t) box.extend(static_cast<Vec3d>(p) / lattice_steps);
    return box;
  }

  static bool disjoint(const LatticeTriangle& a, const LatticeTriangle& b) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto [a_lo, a_hi] = std::minmax({a[0][axis], a[1][axis], a[2][axis]});
      const auto [b_lo, b_hi] = std::minmax({b[0][axis], b[1][axis], b[2][axis]});
      if (a_hi < b_lo || b_hi < a_lo) return true;
    }
    return false;
  }

  static void give_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& self = *static_cast<const PairSearch*>(args->geometryUserPtr);
    const Box3d box = bounds(self.triangles_[args->primID]);
    const auto below = [](double x) { return static_cast<float>(x - margin); };
    const auto above = [](double x) { return static_cast<float>(x + margin); };
    *args->bounds_o = {below(box.lo.x), below(box.lo.y), below(box.lo.z), 0,
                       above(box.hi.x), above(box.hi.y), above(box.hi.z), 0};
  }

  static bool judge(RTCPointQueryFunctionArguments* args) {
    auto& visit = *static_cast<Visit*>(args->userPtr);
    if (args->primID <= visit.triangle) return false;
    const LatticeTriangle& a = visit.self->triangles_[visit.triangle];
    const LatticeTriangle& b = visit.self->triangles_[args->primID];
    if (!disjoint(a, b) && improperly_meet(a, b)) ++visit.met;
    return false;  // the search radius stays
  }

  std::vector<LatticeTriangle> triangles_;
  EmbreeScene scene_;
};

}  // namespace

size_t count_self_intersections(const Mesh& mesh, const Context& context) {
  const PairSearch search(mesh, context);
  std::vector<size_t> met((search.size() + triangles_per_task - 1) / triangles_per_task, 0);
  parallel_chunks(context, search.size(), triangles_per_task, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) met[begin / triangles_per_task] += search.meeting(i);
  });
  size_t pairs = 0;
  for (const size_t count : met) pairs += count;
  return pairs;
}

}  // namespace soapfilm
