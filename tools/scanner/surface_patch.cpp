#include "tools/scanner/surface_patch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/error.h"
#include "tools/scanner/sample_surface.h"

namespace soapfilm {

namespace {

constexpr size_t reference_samples = 40000;
constexpr double reach = 3.0;             // mean spacings to a neighbor on the surface: about 28 of them
constexpr double least_agreement = -0.5;  // cosine between the normals of neighbors: edges yes, the back of a wall no

/// Even samples of the whole surface.
struct Reference {
  std::vector<Vec3d> points;  ///< relative to the box's center
  std::vector<Vec3d> normals;
};

using Neighbors = std::vector<std::pair<uint32_t, double>>;

}  // namespace

struct SurfacePatch::Impl {
  Vec3d origin;  ///< of the frame of the reference
  Reference reference;
  std::unique_ptr<KdTree> tree;
  double radius = 0;  ///< within which reference samples are neighbors
  std::vector<bool> in_patch;

  Neighbors around(Vec3d p) const {
    Neighbors found;
    (*tree)->radiusSearch(&p.x, radius * radius, found, nanoflann::SearchParams());  // nearest first
    return found;
  }

  bool agree(Vec3d a, Vec3d b) const { return dot(a, b) > least_agreement; }

  /// From the first reference sample to ever farther ones, each a neighbor of one before (Prim 1957 with the distance
  /// to the start as the key), until `count` are found.
  void flood(size_t count) {
    using Entry = std::pair<double, uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    std::vector<bool> seen(reference.points.size(), false);
    front.emplace(0.0, 0u);
    seen[0] = true;
    for (size_t taken = 0; taken < count && !front.empty(); ++taken) {
      const uint32_t here = front.top().second;
      front.pop();
      in_patch[here] = true;
      for (const auto& [next, squared] : around(reference.points[here])) {
        if (seen[next] || !agree(reference.normals[here], reference.normals[next])) continue;
        seen[next] = true;
        front.emplace(norm(reference.points[next] - reference.points[0]), next);
      }
    }
  }
};

SurfacePatch::SurfacePatch(const Surface& surface, double share, uint64_t seed) : impl_(std::make_unique<Impl>()) {
  if (!(share >= 0.0 && share <= 1.0)) throw ParameterError(fmt::format("hole = {}, must be in [0, 1]", share));
  Impl& self = *impl_;
  self.origin = surface.box().center();
  const PointCloud even = sample_surface(surface, reference_samples, seed);
  for (const Vec3d& p : even.positions) self.reference.points.push_back(p - self.origin);
  for (const Vec3f& n : even.normals) self.reference.normals.push_back(static_cast<Vec3d>(n));
  self.in_patch.assign(reference_samples, false);
  self.tree = std::make_unique<KdTree>(self.reference.points);
  const double area = surface.tessellate(1e-3 * surface.box().longest()).area();
  self.radius = reach * std::sqrt(area / reference_samples);
  self.flood(static_cast<size_t>(std::llround(share * reference_samples)));
}

SurfacePatch::~SurfacePatch() = default;

bool SurfacePatch::contains(const SurfacePoint& on_surface) const {
  for (const auto& [sample, squared] : impl_->around(on_surface.position - impl_->origin))
    if (impl_->agree(impl_->reference.normals[sample], on_surface.normal)) return impl_->in_patch[sample];
  return false;
}

Vec3d SurfacePatch::center() const { return impl_->origin + impl_->reference.points[0]; }

}  // namespace soapfilm
