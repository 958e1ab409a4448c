// Small problems whose truth is known: sampled shapes on a grid.
#pragma once

#include <string>
#include <utility>

#include "soapfilm/core/random.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {

/// Samples on a grid and their data term.
struct Problem {
  Lattice lattice;
  GridSamples samples;
  SupportField support;
};

/// `resolution` vertices along the longest axis, padding 6.
inline Lattice lattice_of(const PointCloud& cloud, int resolution) {
  constexpr int padding = 6;
  return place_lattice(cloud.box(), voxel_of_resolution(cloud.box(), resolution, padding), padding);
}

/// With the axes in the world's order, whichever is the longest.
inline Lattice unturned(Lattice lattice) {
  lattice.size = lattice.to_world_axes(lattice.size);
  lattice.axis_shift = 0;
  return lattice;
}

inline Problem make_problem(const PointCloud& cloud, const Lattice& lattice, int threads = 1) {
  const Context context(threads);
  Problem problem{lattice, sort_samples(cloud, cloud.normals, lattice, context), {}};
  problem.support = divergence_field(problem.samples, lattice.box(0), context);
  return problem;
}

inline Problem make_problem(const PointCloud& cloud, int resolution) {
  return make_problem(cloud, lattice_of(cloud, resolution));
}

inline double area_of(const Surface& surface) { return surface.tessellate(1e-3 * surface.box().longest()).area(); }

/// Independent samples, `density` of them per voxel^2 of surface when the grid has `resolution` vertices along the
/// longest axis (padding 6).
inline PointCloud sampled(const Surface& surface, int resolution, double density, uint64_t seed = 1) {
  const double voxel = voxel_of_resolution(surface.box(), resolution, 6);
  return sample_surface(surface, static_cast<size_t>(density * area_of(surface) / (voxel * voxel)), seed);
}

inline PointCloud sampled(const std::string& shape, int resolution, double density, uint64_t seed = 1) {
  return sampled(*make_shape(shape), resolution, density, seed);
}

/// Moves every sample along its normal by a normal deviate.
inline void add_noise(PointCloud& cloud, double deviation, uint64_t seed) {
  Random random(seed);
  for (size_t i = 0; i < cloud.size(); ++i)
    cloud.positions[i] += Vec3d(cloud.normals[i]) * (deviation * random.normal());
}

inline PointCloud transformed(PointCloud cloud, const auto& position, const auto& direction) {
  for (Vec3d& p : cloud.positions) p = position(p);
  for (Vec3f& n : cloud.normals) n = direction(n);
  return cloud;
}

inline PyramidSolution solve(const Problem& problem, double lambda, double tolerance, int threads = 1,
                             Norm norm = Norm::isotropic) {
  PrimalDualParams params;
  params.tolerance = tolerance;
  params.max_iterations = 20000;
  const Context context(threads);
  return solve_coarse_to_fine(problem.lattice, problem.support, lambda, params, context, norm);
}

}  // namespace soapfilm::test
