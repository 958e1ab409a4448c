// How many thresholded vertices still change when the tolerance is tightened: what the default was chosen by.
//
//   tolerance FILE [RESOLUTION [LAMBDA_PER_DENSITY]]
//
// Solves once to 1e-6 (at most 600 iterations a level), then to each tolerance, and counts the vertices of the band
// whose side differs; the next level is solved to twice the tolerance, coarser ones to 3e-4 or better all the
// same, 1e-3 where they only tell where to start.
// Prints a Markdown table.
#include <fmt/core.h>

#include <ctime>
#include <string>

#include "soapfilm/field/divergence.h"
#include "soapfilm/field/sampling.h"
#include "soapfilm/io.h"
#include "soapfilm/orient/orient.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"

namespace {

using namespace soapfilm;

size_t differing(const Level& a, const Level& b) {
  size_t count = 0;
  for (size_t brick = 0; brick < a.grid.size(); ++brick) {
    const Vec3i coord = a.grid.coord(brick);
    const int32_t other = b.grid.find(coord);
    for (int i = 0; i < brick_volume; ++i) {
      const float ub = other >= 0 ? b.u.brick(static_cast<size_t>(other))[i] : b.missing_u(other, coord);
      count += (a.u.brick(brick)[i] > 0.5f) != (ub > 0.5f);
    }
  }
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: tolerance FILE [RESOLUTION [LAMBDA_PER_DENSITY]]\n");
    return 2;
  }
  const int resolution = argc > 2 ? std::stoi(argv[2]) : 256;
  const double per_density = argc > 3 ? std::stod(argv[3]) : EnergyParams().lambda_per_density;
  const Context one_thread(1);
  const PointCloud cloud = read_points(argv[1]);
  OrientReport orient_report;
  const auto directions = orient(cloud, {}, one_thread, orient_report);
  constexpr int padding = 6;
  const double voxel = voxel_of_resolution(cloud.box(), resolution, padding);
  const Lattice lattice = place_lattice(cloud.box(), voxel, padding);
  const double lambda = per_density * measure_sampling(cloud, Context()).density(voxel);
  const SupportField support =
      divergence_field(sort_samples(cloud, directions, lattice, one_thread), lattice.box(0), one_thread);

  PrimalDualParams params;
  params.tolerance = 1e-6;
  params.max_iterations = 600;
  const PyramidSolution reference = solve_coarse_to_fine(lattice, support, lambda, params, one_thread);
  params = {};
  params.check_every = 4;
  fmt::print("{} samples, {} vertices, lambda {:.4g}\n\n", cloud.size(), resolution, lambda);
  fmt::print(
      "| tolerance | vertices that change | of the domain | gap of the thresholded u | iterations, coarse to fine "
      "| CPU s |\n|---|---|---|---|---|---|\n");
  for (const double tolerance : {3e-3, 1e-3, 3e-4, 1e-4, 3e-5}) {
    params.tolerance = tolerance;
    const std::clock_t begin = std::clock();
    const PyramidSolution solution = solve_coarse_to_fine(lattice, support, lambda, params, one_thread);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::string iterations;
    for (const LevelReport& level : solution.reports) iterations += fmt::format(" {}", level.iterations);
    const size_t changed = differing(solution.finest, reference.finest);
    const Energies thresholded = evaluate_energy(solution.finest, {.threshold = 0.5f, .certify = true}, one_thread);
    fmt::print("| {:.0e} | {} | {:.1e} | {:.2f} % |{} | {:.2f} |\n", tolerance, changed,
               static_cast<double>(changed) / lattice.vertices(), 100 * thresholded.relative_gap(lambda), iterations,
               seconds);
  }
}
