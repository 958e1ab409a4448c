// Small bands and solved problems for the tests of the sub-voxel fit.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/refine/refine.h"
#include "support/dense.h"
#include "support/problem.h"
#include "tools/mesh/distance.h"

namespace soapfilm::test {

/// A random set of vertices in a box of bricks.
inline NarrowBand random_band(Vec3i bricks, double share, uint64_t seed) {
  const Context context(1);
  BrickGrid grid(BrickMask::whole(bricks), context);
  Random random(seed);
  std::vector<uint8_t> vertices(grid.size() * brick_area);
  for (uint8_t& row : vertices)
    for (int x = 0; x < brick_side; ++x) row |= static_cast<uint8_t>((random.uniform() < share) << x);
  return NarrowBand(std::move(grid), vertices, context);
}

inline NarrowBand random_band(int bricks, double share, uint64_t seed) {
  return random_band(Vec3i{bricks, bricks, bricks}, share, seed);
}

/// Normal deviates on the band, zero elsewhere.
inline RowArray random_array(const NarrowBand& band, uint64_t seed) {
  Random random(seed);
  RowArray array = band.make_array();
  for (size_t i = 0; i < array.size(); ++i)
    if (band.mask(static_cast<uint32_t>(i / brick_side)) >> (i % brick_side) & 1)
      array.data()[i] = static_cast<float>(random.normal());
  return array;
}

/// Sum of a_i b_i.
inline double dot(const RowArray& a, const RowArray& b) {
  return std::inner_product(a.data(), a.data() + a.size(), b.data(), 0.0);
}

/// Independent samples in a box of bricks, with random unit directions.
inline GridSamples random_samples(Vec3i bricks, size_t count, uint64_t seed) {
  Random random(seed);
  GridSamples samples;
  samples.bricks = BrickGrid(BrickMask::whole(bricks), Context(1));
  samples.begin.push_back(0);
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    for (size_t s = 0; s < count / samples.bricks.size(); ++s) {
      const auto coordinate = [&] { return static_cast<float>(random.uniform(0, brick_side)); };
      const auto deviate = [&] { return static_cast<float>(random.normal()); };
      samples.local.push_back({coordinate(), coordinate(), coordinate()});
      samples.direction.push_back(normalized(Vec3f{deviate(), deviate(), deviate()}));
      samples.sample_hash.push_back(static_cast<uint8_t>(Random(samples.sample_hash.size() + 1).next()));
    }
    samples.begin.push_back(static_cast<uint32_t>(samples.local.size()));
  }
  return samples;
}

inline GridSamples random_samples(int bricks, size_t count, uint64_t seed) {
  return random_samples(Vec3i{bricks, bricks, bricks}, count, seed);
}

/// phi0 after two fits of a few steps to samples, the second one with curvature reweighted.
inline std::vector<float> fitted_twice(const NarrowBand& band, const RowArray& phi0, const GridSamples& samples,
                                       int steps, const Context& context) {
  CellSamples cells(samples, band, context);
  merge(phi0, samples, band, {}, {0.3f, 1}, context, cells);
  Displacement displacement(band, phi0, context);
  displacement.precondition(cells, {0.02f, 0.5f});
  displacement.minimize(cells, {0.02f, 0.5f}, {steps, 0});
  displacement.reweight_curvature(1);
  displacement.minimize(cells, {0.02f, 0.5f}, {steps, 0});
  return {displacement.phi().data(), displacement.phi().data() + displacement.phi().size()};
}

/// Errors of a shape's samples.
struct Disturbance {
  double noise_vox = 0;       ///< along the direction
  bool viewing = true;        ///< directions within 80 degrees of the normal; otherwise the normals
  double outliers = 0;        ///< share of the samples that lie anywhere in the box
  double misaligned_vox = 0;  ///< every sample is shifted by this in the direction of one of eight scans
};

inline PointCloud disturbed(const Surface& surface, int resolution, double density, const Disturbance& d) {
  PointCloud cloud = sampled(surface, resolution, density);
  const double voxel = voxel_of_resolution(surface.box(), resolution, 6);
  const Box3d box = surface.box();
  Random random(5);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto unit = [&] { return normalized(Vec3d{random.normal(), random.normal(), random.normal()}); };
    Vec3d direction(cloud.normals[i]);
    if (d.viewing) do
        direction = unit();
      while (dot(direction, Vec3d(cloud.normals[i])) < 0.17);
    cloud.positions[i] += direction * (d.noise_vox * voxel * random.normal());
    const uint64_t scan = random.next() % 8;
    const Vec3d corner{scan & 1 ? 1.0 : -1.0, scan & 2 ? 1.0 : -1.0, scan & 4 ? 1.0 : -1.0};
    cloud.positions[i] += corner * (d.misaligned_vox * voxel / std::sqrt(3.0));
    if (random.uniform() < d.outliers) {
      cloud.positions[i] = {random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                            random.uniform(box.lo.z, box.hi.z)};
      direction = unit();
    }
    cloud.normals[i] = Vec3f(direction);
  }
  return cloud;
}

/// A shape's samples, solved; ready to be refined.
struct Solved {
  std::shared_ptr<const Surface> truth;
  double density;  ///< samples per voxel^2
  Problem problem;
  PyramidSolution solution;

  Solved(std::shared_ptr<const Surface> surface, int resolution, double density, const Disturbance& d)
      : truth(std::move(surface)),
        density(density),
        problem(make_problem(disturbed(*truth, resolution, density, d),
                             place_lattice(truth->box(), voxel_of_resolution(truth->box(), resolution, 6), 6))),
        solution(solve(problem, 0.02 * density, 1e-3)) {}
  Solved(const std::string& shape, int resolution, double density = 1, const Disturbance& d = {})
      : Solved(make_shape(shape), resolution, density, d) {}
};

struct Refined {
  DistanceField field;
  FitReport report;
  Mesh mesh;
};

template <class Field>
Mesh mesh_of(const Field& field, float isovalue, const Lattice& lattice) {
  return extract_isosurface(
      field.grid, field.value, [&](Vec3i brick) { return field.missing_value(brick); }, isovalue, lattice, Context(1));
}

inline Refined refined(const Solved& solved, const RefineSetup& params = {}, int threads = 1) {
  Refined result;
  result.field = refine(labels_of(solved.solution.finest, 0.5f, Context(1)), solved.problem.samples, solved.density,
                        params, Context(threads), result.report);
  result.mesh = mesh_of(result.field, 0, solved.problem.lattice);
  return result;
}

/// Mean distance from the truth to a mesh, voxels.
inline double mean_error_vox(const Solved& solved, const Mesh& mesh) {
  const PointCloud truth = sample_surface(*solved.truth, 10000, 77);
  return point_to_mesh_distance(truth.positions, mesh, Context(1)).mean / solved.problem.lattice.voxel;
}

}  // namespace soapfilm::test
