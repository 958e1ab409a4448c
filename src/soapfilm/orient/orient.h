#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/core/progress.h"
namespace soapfilm {
enum class DirectionSource { automatic, normals, sensor, scan, estimate };
struct OrientParams {
  DirectionSource source = DirectionSource::automatic;
  std::optional<Vec3d> sensor;
  int neighbours = 16;
};
struct OrientReport {
  size_t from_normals = 0, from_sensor = 0, from_scan = 0, estimated = 0;
  size_t without_direction = 0;
  std::vector<std::string> warnings;
};
std::vector<Vec3f> orient(const PointCloud&, const OrientParams&, const Parallel&, Progress&, OrientReport&);
}  // namespace soapfilm
