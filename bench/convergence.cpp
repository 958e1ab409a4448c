// How the proved gap shrinks: tv-sor, tv from zero and tv with the pyramid, on one problem. Prints CSV:
// method,level,iterations,seconds,relative_gap with the gap of the relaxed u on the finest grid.
// Usage: bench_convergence INPUT RESOLUTION LAMBDA [SOR_ITERATIONS]
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "soapfilm/io/io.h"
#include "soapfilm/orient/orient.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/solve/sor.h"

namespace {

using namespace soapfilm;

/// Seconds of solving: what is spent on evaluating and printing is taken out.
class Stopwatch {
 public:
  double seconds() const { return spent_ + std::chrono::duration<double>(Clock::now() - begin_).count(); }
  template <class Work>
  void pause(Work&& work) {
    spent_ = seconds();
    work();
    begin_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;
  double spent_ = 0;
  Clock::time_point begin_ = Clock::now();
};

void print(const char* method, int level, int iterations, double seconds, double gap) {
  fmt::print("{},{},{},{:.4f},{:.6e}\n", method, level, iterations, seconds, gap);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return fmt::print(stderr, "usage: bench_convergence INPUT RESOLUTION LAMBDA [SOR_ITERATIONS]\n"), 2;
  const PointCloud cloud = read_points(argv[1]);
  const double lambda = std::atof(argv[3]);
  const Parallel parallel(1);
  Progress progress;
  OrientReport oriented;
  const auto directions = orient(cloud, {}, parallel, progress, oriented);
  const double voxel = voxel_of_resolution(cloud.box(), std::atoi(argv[2]), 6);
  const Lattice lattice = place_lattice(cloud.box(), voxel, 6);
  const SupportField field =
      divergence_field(sort_samples(cloud, directions, lattice, parallel), lattice.box(0), parallel);

  PrimalDualParams tight;
  tight.tolerance = 1e-6;
  tight.check_every = 4;
  tight.max_iterations = 600;
  fmt::print("method,level,iterations,seconds,relative_gap\n");
  {
    Stopwatch watch;
    PyramidObserver observer;
    observer.check = [&](int level, int iterations, double level_lambda, const Energies& e) {
      print("tv", level, iterations, watch.seconds(), e.relative_gap(level_lambda));
    };
    // Coarse levels to the default tolerance: it is the finest that is watched.
    solve_coarse_to_fine(lattice, field, lambda, Norm::isotropic, tight, parallel, progress, observer);
  }
  {
    Stopwatch watch;
    BrickMask everywhere(lattice.box(0).bricks);
    everywhere.fill(true);
    Level level = make_level(lattice.box(0), static_cast<float>(lambda), everywhere, field.grid, field.f, parallel);
    solve_primal_dual(level, tight, parallel, progress, [&](int iterations, const Energies& e) {
      print("tv from zero", 0, iterations, watch.seconds(), e.relative_gap(level.lambda));
    });
  }
  {
    SorParams params;
    if (argc > 4) params.max_iterations = std::atoi(argv[4]);
    Stopwatch watch;
    std::vector<SorLevelReport> reports;
    // TODO observe
    solve_sor(lattice, field, lambda, params, parallel, progress, reports);
  }
}
