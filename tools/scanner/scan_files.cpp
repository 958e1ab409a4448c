#include "tools/scanner/scan_files.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/io/sets/scan_set.h"

namespace soapfilm {

namespace {

PointCloud scan_in_own_frame(const ScanSet& set, size_t scan) {
  const Pose& pose = set.poses[scan];
  Scan own = set.cloud.scans[scan];
  PointCloud cloud;
  for (size_t i = own.begin; i < own.end; ++i) {
    cloud.positions.push_back(pose.to_local(set.cloud.positions[i]));
    if (set.cloud.normals.empty()) continue;
    const auto n = static_cast<Vec3d>(set.cloud.normals[i]);
    cloud.normals.push_back(static_cast<Vec3f>(Vec3d{dot(pose.x, n), dot(pose.y, n), dot(pose.z, n)}));
  }
  own.begin = 0;
  own.end = cloud.size();
  // Exactly, without the rounding of the transformation to the world and back.
  if (own.sensor) own.sensor = Vec3d{0, 0, 0};
  if (own.view_direction) own.view_direction = Vec3d{0, 0, 1};
  cloud.scans.push_back(std::move(own));
  return cloud;
}

}  // namespace

void write_scans(const std::string& folder, const std::string& conf_name, const ScanSet& set, const Context& context) {
  const std::filesystem::path base(folder);
  std::vector<ScanSetEntry> entries;
  for (size_t k = 0; k < set.poses.size(); ++k) {
    context.check();
    const std::string file = set.cloud.scans[k].name + ".ply";
    write_points((base / file).string(), scan_in_own_frame(set, k));
    entries.push_back({file, {set.poses[k].origin, set.poses[k].stanford_quaternion()}});
    context.progress().advance(static_cast<double>(k + 1) / static_cast<double>(set.poses.size()), file);
  }
  write_scan_set((base / conf_name).string(), entries);
}

}  // namespace soapfilm
