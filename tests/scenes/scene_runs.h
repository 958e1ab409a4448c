// Small scenes, reconstructed by defaults, and what is lost of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "soapfilm/mesh/topology.h"
#include "soapfilm/mesh/triangle_normal.h"
#include "soapfilm/reconstruct.h"
#include "tools/mesh/distance.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/scene.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm::test {

/// The scene's own scanner with smaller range images, hits with noise along the ray.
inline PointCloud scanned(const Scene& scene, int columns, int rows, double noise) {
  ScannerParams params = scene.scanner;
  params.columns = columns;
  params.rows = rows;
  params.noise = noise;
  return virtual_scan(MeshSurface(scene.mesh, Context(1), Faces::as_given), params, Context(1)).cloud;
}

/// Even samples of a scene, each with the position of the one scanner.
inline PointCloud even_with_sensor(const Scene& scene, size_t count, Vec3d sensor, double noise) {
  const MeshSurface surface(scene.mesh, Context(1), Faces::as_given);
  SamplingParams params{.count = count, .noise = noise};
  params.sensors = {sensor};
  return sample_surface(surface, params, Context(1));
}

struct SceneRun {
  Reconstruction result;
  TopologyReport topology;
  double lost = 1;        ///< share of the samples farther than 3 voxels from the surface
  double wrong_side = 1;  ///< share of the samples whose nearest face looks away from `sides`
};

/// By defaults, but for `outside`. `sides`: of each sample, a direction into the air; `counts`: which samples may not
/// be lost, by the voxel.
inline SceneRun run_scene(const PointCloud& cloud, const std::vector<Vec3d>& sides = {},
                          const std::function<bool(size_t, double)>& counts = {}, Border outside = Border::automatic) {
  ReconstructParams params;
  params.border.outside = outside;
  SceneRun run{reconstruct(cloud, params, Context(1)), {}};
  run.topology = check_topology(run.result.mesh);
  const ClosestPointQuery nearest(run.result.mesh, Context(1));
  const std::vector<ClosestPoint> found = nearest(cloud.positions, Context(1));
  const double voxel = run.result.report.grid.voxel;
  double lost = 0, wrong = 0, all = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    if (counts && !counts(i, voxel)) continue;
    all += 1;
    lost += found[i].distance > 3 * voxel;
    if (!sides.empty()) wrong += dot(triangle_normal(run.result.mesh, found[i].triangle), sides[i]) < 0;
  }
  run.lost = lost / all;
  run.wrong_side = sides.empty() ? 0 : wrong / all;
  return run;
}

inline std::vector<Vec3d> towards_scanners(const PointCloud& cloud) {
  std::vector<Vec3d> ways(cloud.size());
  for (const Scan& scan : cloud.scans)
    for (size_t i = scan.begin; i < scan.end; ++i)
      ways[i] = (cloud.sensors.empty() ? *scan.sensor : cloud.sensors[i]) - cloud.positions[i];
  return ways;
}

inline std::vector<Vec3d> true_normals(const PointCloud& cloud) {
  std::vector<Vec3d> normals(cloud.size());
  std::transform(cloud.normals.begin(), cloud.normals.end(), normals.begin(),
                 [](Vec3f n) { return static_cast<Vec3d>(n); });
  return normals;
}

}  // namespace soapfilm::test
