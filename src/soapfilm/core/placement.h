// Moving scans to where they were taken: by the poses that files give, and those of programs.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// p_world = linear p_scan + translation; `linear` is a rotation, or one times `scale` > 0.
struct Placement {
  std::array<Vec3d, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows
  double scale = 1;
  Vec3d translation;

  bool operator==(const Placement&) const = default;
  Vec3d apply(Vec3d p) const {
    return {dot(linear[0], p) + translation.x, dot(linear[1], p) + translation.y, dot(linear[2], p) + translation.z};
  }
  Vec3d rotate(Vec3d v) const {
    return {dot(linear[0], v) / scale, dot(linear[1], v) / scale, dot(linear[2], v) / scale};
  }
};

/// The textbook rotation of a quaternion of any length but 0.
Placement placement_of_quaternion(double w, double x, double y, double z);

/// From the rows of a 4 x 4 matrix for column vectors. If it is no rotation with a scale and a translation, `error`
/// says what it is instead.
Placement placement_of_matrix(const std::array<double, 16>& matrix, std::string& error);

/// Moves the samples [begin, end): positions, normals, sensor positions.
template <class Pose>
void place_samples(const Pose& pose, PointCloud& cloud, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) cloud.positions[i] = pose.apply(cloud.positions[i]);
  if (!cloud.normals.empty())
    for (size_t i = begin; i < end; ++i)
      cloud.normals[i] = static_cast<Vec3f>(pose.rotate(static_cast<Vec3d>(cloud.normals[i])));
  if (!cloud.sensors.empty())
    for (size_t i = begin; i < end; ++i) cloud.sensors[i] = pose.apply(cloud.sensors[i]);
}

/// Moves a whole cloud, with its scans' sensor positions and view directions.
template <class Pose>
void place_cloud(const Pose& pose, PointCloud& cloud) {
  place_samples(pose, cloud, 0, cloud.size());
  for (Scan& scan : cloud.scans) {
    if (scan.sensor) scan.sensor = pose.apply(*scan.sensor);
    if (scan.view_direction) scan.view_direction = pose.rotate(*scan.view_direction);
  }
}

}  // namespace soapfilm
