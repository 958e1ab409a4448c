// How the proved gap shrinks: tv-sor, tv from zero and tv with the pyramid, on one problem. Prints CSV:
// method,level,iterations,seconds,relative_gap with the gap of the relaxed u on the finest grid.
// Usage: bench_convergence INPUT RESOLUTION LAMBDA
#include <fmt/core.h>

#include <cstdlib>
#include <ctime>

#include "soapfilm/io.h"
#include "soapfilm/orient/orient.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/pyramid/sor_pyramid.h"

namespace {

using namespace soapfilm;

/// CPU seconds of solving; what tv-sor's observer spends on the certificate is taken out (tv evaluates it anyway).
class Stopwatch {
 public:
  double seconds() const { return spent_ + static_cast<double>(std::clock() - begin_) / CLOCKS_PER_SEC; }
  template <class Work>
  void pause(Work&& work) {
    spent_ = seconds();
    work();
    begin_ = std::clock();
  }

 private:
  double spent_ = 0;
  std::clock_t begin_ = std::clock();
};

void print(const char* method, int level, int iterations, double seconds, double gap) {
  fmt::print("{},{},{},{:.4f},{:.6e}\n", method, level, iterations, seconds, gap);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return fmt::print(stderr, "usage: bench_convergence INPUT RESOLUTION LAMBDA\n"), 2;
  const PointCloud cloud = read_points(argv[1]);
  const double lambda = std::atof(argv[3]);
  const Context context(1);
  OrientReport oriented;
  const auto directions = orient(cloud, {}, context, oriented);
  const double voxel = voxel_of_resolution(cloud.box(), std::atoi(argv[2]), 6);
  const Lattice lattice = place_lattice(cloud.box(), voxel, 6);
  const SupportField field =
      divergence_field(sort_samples(cloud, directions, lattice, context), lattice.box(0), context);

  PrimalDualParams tight;
  tight.tolerance = 1e-5;
  tight.check_every = 4;
  tight.max_iterations = 400;
  fmt::print("method,level,iterations,seconds,relative_gap\n");
  {
    Stopwatch watch;
    PyramidObserver observer;
    observer.evaluated = [&](const Level& level, int iterations, const Energies& e) {
      print("tv", level.box.level, iterations, watch.seconds(), e.relative_gap(level.lambda));
    };
    solve_coarse_to_fine(lattice, field, lambda, tight, context, Norm::isotropic, observer);
  }
  {
    Stopwatch watch;
    Level level = make_level(lattice.box(0), static_cast<float>(lambda), BrickMask::whole(lattice.box(0).bricks),
                             field.grid, field.f, context);
    PrimalDualRun run;
    run.evaluated = [&](int iterations, const Energies& e) {
      print("tv from zero", 0, iterations, watch.seconds(), e.relative_gap(level.lambda));
    };
    solve_primal_dual(level, tight, context, run);
  }
  {
    SorParams params;
    params.tolerance = 0;
    params.max_iterations = tight.max_iterations;
    Stopwatch watch;
    std::vector<SorLevelReport> reports;
    solve_sor(lattice, field, lambda, params, context, reports, [&](const SorState& state) {
      if (state.box.level != 0 || (state.iterations > 20 && state.iterations % 10 != 0)) return;
      const double seconds = watch.seconds();
      watch.pause([&] {
        const Level level = sor_level(state.u, state.box, state.lambda, state.support, params, context);
        const Energies e = evaluate_energy(level, {}, context);
        print("tv-sor", 0, state.iterations, seconds, e.relative_gap(level.lambda));
      });
    });
  }
}
