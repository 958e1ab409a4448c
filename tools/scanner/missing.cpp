#include "tools/scanner/missing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "tools/scanner/surface_patch.h"

namespace soapfilm {

namespace {

constexpr size_t samples_per_task = 1024;

void check(const MissingParams& params) {
  if (!(params.hole >= 0.0 && params.hole <= 0.9))
    throw ParameterError(fmt::format("hole = {}, must be in [0, 0.9]", params.hole));
  if (!(params.sparse_half >= 1.0 && std::isfinite(params.sparse_half)))
    throw ParameterError(fmt::format("sparse_half = {}, must be >= 1", params.sparse_half));
}

int longest_axis(const Box3d& box) {
  const Vec3d size = box.size();
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

}  // namespace

std::vector<bool> kept_samples(const Surface& surface, const PointCloud& cloud, const MissingParams& params,
                               const Context& context) {
  check(params);
  std::vector<bool> keep(cloud.size(), true);
  if (params.hole > 0.0) {
    const SurfacePatch patch(surface, params.hole, params.seed);
    std::vector<uint8_t> lost(cloud.size());  // bytes: threads write them
    parallel_for(context, cloud.size(), samples_per_task,
                 [&](size_t i) { lost[i] = patch.contains(surface.closest(cloud.positions[i])) ? 1 : 0; });
    for (size_t i = 0; i < cloud.size(); ++i) keep[i] = lost[i] == 0;
  }
  if (params.sparse_half > 1.0) {
    const int axis = longest_axis(surface.box());
    const double middle = surface.box().center()[axis];
    Random random(params.seed);
    for (size_t i = 0; i < cloud.size(); ++i) {
      const bool stays = random.uniform() * params.sparse_half < 1.0;
      if (cloud.positions[i][axis] > middle && !stays) keep[i] = false;
    }
  }
  if (std::find(keep.begin(), keep.end(), true) == keep.end())
    throw ParameterError(fmt::format("hole = {}, sparse_half = {}: none of {} samples is left", params.hole,
                                     params.sparse_half, cloud.size()));
  return keep;
}

void filter(ScanSet& set, const std::vector<bool>& keep) {
  std::vector<Pose> poses;
  for (size_t k = 0; k < set.cloud.scans.size(); ++k) {
    const auto begin = keep.begin() + static_cast<std::ptrdiff_t>(set.cloud.scans[k].begin);
    const auto end = keep.begin() + static_cast<std::ptrdiff_t>(set.cloud.scans[k].end);
    if (std::find(begin, end, true) != end) poses.push_back(set.poses[k]);
  }
  set.poses = std::move(poses);
  set.cloud.filter(keep);
}

}  // namespace soapfilm
