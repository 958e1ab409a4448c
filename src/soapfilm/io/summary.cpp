#include "soapfilm/io/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/median.h"

namespace soapfilm {

double sample_spacing(const PointCloud& cloud, size_t queries) {
  constexpr size_t neighbors = 8;
  const size_t k = std::min(neighbors, cloud.size() - std::min<size_t>(cloud.size(), 1));
  if (k == 0 || queries == 0) return 0;
  const KdTree tree(cloud.positions);

  const size_t step = std::max<size_t>(1, cloud.size() / queries);
  std::vector<double> areas;
  for (size_t i = 0; i < cloud.size(); i += step) {
    const Vec3d& p = cloud.positions[i];
    const std::array<double, 3> query{p.x, p.y, p.z};
    std::array<uint32_t, neighbors + 1> index{};  // the sample itself comes first
    std::array<double, neighbors + 1> squared_distance{};
    const size_t found = tree->knnSearch(query.data(), k + 1, index.data(), squared_distance.data());
    const double farthest = squared_distance[found - 1];
    constexpr double pi = 3.141592653589793;
    if (farthest > 0) areas.push_back(pi * farthest / static_cast<double>(found - 1));
  }
  return std::sqrt(median(std::move(areas)));
}

CloudSummary summarize(const PointCloud& cloud) {
  CloudSummary summary;
  summary.box = cloud.box();
  summary.spacing = sample_spacing(cloud);
  for (const Vec3f& n : cloud.normals) summary.normals += !(n == Vec3f{});
  for (const Vec3d& s : cloud.sensors) summary.sensors += is_finite(s);
  for (const Scan& scan : cloud.scans) {
    summary.scans_with_sensor += scan.sensor.has_value();
    summary.scans_with_view_direction += scan.view_direction.has_value();
    summary.scans_with_range_grid += scan.range_grid.has_value();
  }
  return summary;
}

}  // namespace soapfilm
