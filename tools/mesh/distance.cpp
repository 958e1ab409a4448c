#include "tools/mesh/distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "tools/mesh/triangle_tree.h"

namespace soapfilm {

namespace {

constexpr size_t points_per_task = 1024;
constexpr double infinity = std::numeric_limits<double>::infinity();

void require_finite(const std::vector<Vec3d>& points, size_t i) {
  if (!is_finite(points[i])) throw ParameterError(fmt::format("point {} is not finite", i));
}

}  // namespace

struct ClosestPointQuery::Impl {
  TreeFrame frame;
  TriangleTree tree;
};

ClosestPointQuery::ClosestPointQuery(const Mesh& mesh, const Context& context) {
  const TreeFrame frame = TreeFrame::of(mesh);
  impl_.reset(new Impl{frame, TriangleTree(mesh, frame, 0, mesh.triangles.size(), context)});
}

ClosestPointQuery::~ClosestPointQuery() = default;
ClosestPointQuery::ClosestPointQuery(ClosestPointQuery&&) noexcept = default;
ClosestPointQuery& ClosestPointQuery::operator=(ClosestPointQuery&&) noexcept = default;

ClosestPoint ClosestPointQuery::operator()(Vec3d point) const {
  ClosestPoint found = impl_->tree.search(point - impl_->frame.center);
  found.position += impl_->frame.center;
  return found;
}

std::vector<ClosestPoint> ClosestPointQuery::operator()(const std::vector<Vec3d>& points,
                                                        const Context& context) const {
  const Vec3d center = impl_->frame.center;
  std::vector<ClosestPoint> found(points.size());
  parallel_chunks(context, points.size(), points_per_task, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      require_finite(points, i);
      // The triangle closest to the previous point is no farther than this.
      const double limit = i == begin ? infinity : found[i - 1].distance + norm(points[i] - points[i - 1]);
      found[i] = impl_->tree.search(points[i] - center, limit);
    }
    for (size_t i = begin; i < end; ++i) found[i].position += center;
  });
  return found;
}

std::vector<double> distances_to_mesh(const std::vector<Vec3d>& points, const Mesh& mesh, const Context& context) {
  const auto found = ClosestPointQuery(mesh, context)(points, context);
  std::vector<double> distances(found.size());
  std::transform(found.begin(), found.end(), distances.begin(), [](const ClosestPoint& c) { return c.distance; });
  return distances;
}

namespace {

/// A mesh's triangles, in runs of them.
class MeshParts {
 public:
  MeshParts(const Mesh& mesh, size_t part_triangles, const Context& context)
      : mesh_(mesh), frame_(TreeFrame::of(mesh)), part_triangles_(part_triangles), context_(context) {
    boxes_.resize((mesh.triangles.size() + part_triangles - 1) / part_triangles);
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) boxes_[i / part_triangles].extend(frame_.corner(mesh, i, k));
  }

  size_t count() const { return boxes_.size(); }
  Vec3d relative(Vec3d point) const { return point - frame_.center; }
  TriangleTree tree(size_t part) const {
    const size_t begin = part * part_triangles_;
    return {mesh_, frame_, begin, std::min(mesh_.triangles.size(), begin + part_triangles_), context_};
  }

  /// Less than to any of the part's triangles, as they are measured: that rounds parts of the coordinates' size.
  double least_distance(size_t part, Vec3d relative) const {
    constexpr double rounding = 1e-12;
    const Box3d& box = boxes_[part];
    Vec3d apart;
    for (int axis = 0; axis < 3; ++axis)
      apart[axis] = std::max({box.lo[axis] - relative[axis], relative[axis] - box.hi[axis], 0.0});
    return norm(apart) - rounding * (norm(relative) + 1 / frame_.to_unit);
  }
  size_t nearest(Vec3d relative) const {
    size_t best = 0;
    double least = infinity;
    for (size_t part = 0; part < count(); ++part)
      if (const double apart = least_distance(part, relative); apart < least) {
        least = apart;
        best = part;
      }
    return best;
  }

 private:
  const Mesh& mesh_;
  TreeFrame frame_;
  size_t part_triangles_;
  const Context& context_;
  std::vector<Box3d> boxes_;
};

}  // namespace

std::vector<double> distances_by_parts(const std::vector<Vec3d>& points, const Mesh& mesh, size_t part_triangles,
                                       const Context& context) {
  const MeshParts parts(mesh, part_triangles, context);
  std::vector<double> distances(points.size(), infinity);
  std::vector<uint32_t> first(points.size());  // the part that each point looks at first
  parallel_chunks(context, points.size(), points_per_task, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      require_finite(points, i);
      first[i] = static_cast<uint32_t>(parts.nearest(parts.relative(points[i])));
    }
  });
  const auto look_at = [&](size_t part, auto&& needs) {
    const TriangleTree tree = parts.tree(part);
    parallel_chunks(context, points.size(), points_per_task, [&](size_t begin, size_t end) {
      size_t last = end;
      for (size_t i = begin; i < end; ++i) {
        if (!needs(i)) continue;
        // The triangle closest to the previous point is no farther than this.
        const double near = last < end ? distances[last] + norm(points[i] - points[last]) : infinity;
        const double limit = std::min(distances[i], near);
        distances[i] = std::min(distances[i], tree.search(parts.relative(points[i]), limit).distance);
        last = i;
      }
    });
  };
  const auto is_first = [&](size_t part, size_t i) { return first[i] == part; };
  const auto is_nearer = [&](size_t part, size_t i) {
    return first[i] != part && parts.least_distance(part, parts.relative(points[i])) < distances[i];
  };
  const auto for_parts = [&](auto&& needs) {
    for (size_t part = 0; part < parts.count(); ++part) {
      std::atomic<bool> any{false};
      parallel_chunks(context, points.size(), points_per_task, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end && !any; ++i)
          if (needs(part, i)) any = true;
      });
      if (any) look_at(part, [&](size_t i) { return needs(part, i); });
    }
  };
  for_parts(is_first);
  for_parts(is_nearer);
  return distances;
}

DistanceSummary summarize(std::vector<double> distances) {
  DistanceSummary out;
  out.count = distances.size();
  if (distances.empty()) return out;
  std::sort(distances.begin(), distances.end());  // small ones first: most accurate sums
  double sum = 0;
  double squares = 0;
  for (const double d : distances) {
    sum += d;
    squares += d * d;
  }
  const auto n = static_cast<double>(distances.size());
  const auto percentile = [&](double p) {
    return distances[static_cast<size_t>(std::max(1.0, std::ceil(p / 100 * n))) - 1];
  };
  out.mean = sum / n;
  out.rms = std::sqrt(squares / n);
  out.maximum = distances.back();
  out.percentile95 = percentile(95);
  out.percentile99 = percentile(99);
  return out;
}

DistanceSummary point_to_mesh_distance(const std::vector<Vec3d>& points, const Mesh& mesh, const Context& context) {
  return summarize(distances_to_mesh(points, mesh, context));
}

}  // namespace soapfilm
