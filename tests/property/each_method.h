// Clouds and parameters for the reconstruction with each method.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "soapfilm/core/names.h"
#include "soapfilm/reconstruct.h"
#include "support/problem.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm::test {

constexpr int resolution = 56;
constexpr double density = 2;  // samples per voxel^2

inline ReconstructParams params_of(Method method) {
  ReconstructParams params;
  params.method = method;
  params.place.resolution = resolution;
  return params;
}

inline Reconstruction reconstructed(const PointCloud& cloud, const ReconstructParams& params, int threads = 1) {
  return reconstruct(cloud, params, Context(threads));
}

inline Reconstruction reconstructed(const std::string& shape, Method method) {
  return reconstructed(sampled(shape, resolution, density), params_of(method));
}

/// A sphere of diameter 1 as range scans, about one sample per voxel^2 of a grid with `vertices` along an axis: one
/// scan for each scanner position; without positions, all around.
inline PointCloud range_scans(const std::vector<Vec3d>& positions = {}, int vertices = resolution) {
  ScannerParams scanner;
  scanner.step = 1.0 / (vertices - 12);
  scanner.positions = positions;
  return virtual_scan(*make_sphere(), scanner, Context(1)).cloud;
}

inline std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// Records which stages began.
struct StageList : Progress {
  void begin_stage(std::string_view name) override { names.emplace_back(name); }
  std::vector<std::string> names;
};

inline std::string method_name(const testing::TestParamInfo<Method>& info) { return identifier(name_of(info.param)); }

}  // namespace soapfilm::test
