// What the passes of the sub-voxel fit cost, one thread: in bytes per second of elapsed time beside a plain copy in the
// same run, counting what each must read and write once, and in nanoseconds per row of eight vertices.
//
//   bench_kernels_refine [--benchmark_filter=...]
//
// The band of a sphere with noisy samples, one per voxel^2: of 50 voxels radius, in the last cache, and of 250, beyond.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "plain_copy.h"
#include "soapfilm/core/random.h"
#include "soapfilm/refine/fit/displacement.h"
#include "soapfilm/refine/fit/multilevel.h"

namespace {

using namespace soapfilm;

constexpr double reach = 3, noise = 1.0 / 3;  // voxels
constexpr DataWeights weights{.normal = 0, .slope = 8};
constexpr Smoothness smoothness{.slope = 0.02f, .curvature = 1};

/// The vertices near a sphere in the middle of its grid, and samples on it seen from far outside.
struct Ball {
  explicit Ball(int voxels) : bricks(2 * (voxels + 8) / brick_side), radius(voxels) {
    make_band();
    make_samples();
    displacement = std::make_unique<Displacement>(band, phi0, context);
    cells = CellSamples(samples, band, context);
    weigh();
    displacement->precondition(cells, smoothness);
  }

  void weigh() {
    merge(phi0, samples, band, {Penalty::tukey, static_cast<float>(2.5 * noise), true, {}}, weights, context, cells);
  }
  double height(Vec3i vertex) const { return radius - norm(Vec3d(vertex) - middle()); }
  Vec3d middle() const { return Vec3d{1, 1, 1} * (0.5 * bricks * brick_side); }

  void make_band() {
    constexpr double diagonal = 1.75 * brick_side;  // of a brick
    BrickMask near({bricks, bricks, bricks});
    for (int z = 0; z < bricks; ++z)
      for (int y = 0; y < bricks; ++y)
        for (int x = 0; x < bricks; ++x)
          if (std::abs(height(Vec3i{x, y, z} * brick_side)) < diagonal + reach) near.set({x, y, z});
    BrickGrid grid(near, context);
    std::vector<uint8_t> vertices(grid.size() * brick_area);
    for_vertices(grid, [&](size_t row, int x, Vec3i vertex) {
      if (std::abs(height(vertex)) < reach) vertices[row] |= static_cast<uint8_t>(1 << x);
    });
    band = NarrowBand(std::move(grid), vertices, context);
    phi0 = band.make_array();
    for_vertices(band.grid(), [&](size_t row, int x, Vec3i vertex) {
      const uint32_t r = band.rows_of(static_cast<int32_t>(row / brick_area))[row % brick_area];
      if (band.mask(r) >> x & 1)
        phi0.data()[r * brick_side + static_cast<size_t>(x)] = static_cast<float>(height(vertex));
    });
  }

  /// visit(brick_area brick + y + 8 z, x, vertex) for all vertices of a grid.
  template <class Visit>
  static void for_vertices(const BrickGrid& grid, Visit&& visit) {
    for (size_t b = 0; b < grid.size(); ++b)
      for (int row = 0; row < brick_area; ++row)
        for (int x = 0; x < brick_side; ++x)
          visit(b * brick_area + static_cast<size_t>(row), x,
                grid.first_vertex(b) + Vec3i{x, row % brick_side, row / brick_side});
  }

  void make_samples() {
    Random random(1);
    PointCloud cloud;
    cloud.scans.emplace_back();
    std::vector<Vec3f> directions;
    const auto count = static_cast<size_t>(12.566 * radius * radius);
    for (size_t s = 0; s < count; ++s) {
      const Vec3d normal = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
      cloud.positions.push_back(middle() + normal * (radius + noise * random.normal()));
      directions.push_back(Vec3f(normal));
    }
    Lattice lattice;  // vertex (1, 1, 1), the first that is reported, lies at (1, 1, 1)
    lattice.size = Vec3i{1, 1, 1} * (bricks * brick_side - 2);
    lattice.first_vertex = {1, 1, 1};
    samples = sort_samples(cloud, directions, lattice, context);
  }

  Context context{1};
  int bricks, radius;
  NarrowBand band;
  RowArray phi0;
  GridSamples samples;
  CellSamples cells;
  std::unique_ptr<Displacement> displacement;
};

Ball& ball(benchmark::State& state) {
  static std::map<int64_t, std::unique_ptr<Ball>> made;
  std::unique_ptr<Ball>& found = made[state.range(0)];
  if (!found) found = std::make_unique<Ball>(static_cast<int>(state.range(0)));
  return *found;
}

constexpr double row_bytes = brick_side * sizeof(float), neighbor_bytes = 6 * sizeof(uint32_t);

/// `pass` again and again; once before that, so that all pages are there.
template <class Pass>
void repeat(benchmark::State& state, Pass&& pass) {
  pass();
  for (auto _ : state) pass();
}

void count(benchmark::State& state, const Ball& b, double bytes_per_row) {
  const auto rows = static_cast<double>(b.band.rows());
  state.SetBytesProcessed(static_cast<int64_t>(static_cast<double>(state.iterations()) * rows * bytes_per_row));
  state.counters["ns_per_row"] =
      benchmark::Counter(rows * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void copy(benchmark::State& state) {
  const Ball& b = ball(state);
  RowArray to = b.band.make_array();
  repeat(state, [&] {
    plain_copy(b.phi0.data(), to.data(), b.phi0.size());
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  });
  count(state, b, 2 * row_bytes);
}

/// Both of them, coarse levels and all. Of the finest level b and inverse are read to restrict the residual; b and
/// inverse again, the correction written; that, b and inverse once more, the result written.
void v_cycles(benchmark::State& state) {
  Ball& b = ball(state);
  Multilevel multilevel(b.band, b.context);
  RowArray position_weights = b.band.make_array(), z = b.band.make_array(), work = b.band.make_array();
  DataTerm::row_sums(b.band, b.cells, position_weights).add(b.context);
  multilevel.set_operator(position_weights, smoothness.slope, smoothness.curvature, b.context);
  repeat(state, [&] { benchmark::DoNotOptimize(multilevel.apply([](int) {}, b.phi0, z, work, b.context)); });
  count(state, b, 2 * (9 * row_bytes + 2 * neighbor_bytes));
}

void laplacian(benchmark::State& state) {
  Ball& b = ball(state);
  RowArray out = b.band.make_array();
  repeat(state, [&] { benchmark::DoNotOptimize(apply_laplacian(b.band, b.phi0, 0, 1, out, b.context)); });
  count(state, b, 2 * row_bytes + neighbor_bytes);
}

/// Of the cells their seven values, phi in, what is added to in and out.
void data_term(benchmark::State& state) {
  Ball& b = ball(state);
  RowArray out = b.band.make_array();
  const DataTerm term = DataTerm::gradient(b.band, b.cells, b.phi0, -1, out);
  repeat(state, [&] { benchmark::DoNotOptimize(term.add(b.context)); });
  const double cells = static_cast<double>(b.cells.count) / static_cast<double>(b.band.rows());
  count(state, b, cells * DataJob::values * sizeof(float) + 3 * row_bytes + neighbor_bytes);
}

/// Of the samples place and direction, of the cells their seven values, phi in.
void merge_samples(benchmark::State& state) {
  Ball& b = ball(state);
  repeat(state, [&] { b.weigh(); });
  const double cells = static_cast<double>(b.cells.count), rows = static_cast<double>(b.band.rows());
  count(state, b,
        (static_cast<double>(b.samples.size()) * 2 * sizeof(Vec3f) + cells * DataJob::values * sizeof(float)) / rows +
            row_bytes);
}

/// Bends, their means around and the shares: phi, phi0, the old target in, shares and target out, four arrays between.
void reweight_curvature(benchmark::State& state) {
  Ball& b = ball(state);
  repeat(state, [&] { b.displacement->reweight_curvature(1.2); });
  count(state, b, (5 + 8) * row_bytes + 2 * neighbor_bytes);
}

/// A residual and two steps: all that the fit repeats but the weighing. Its bytes are those of what it is made of.
void two_steps(benchmark::State& state) {
  Ball& b = ball(state);
  for (auto _ : state)
    benchmark::DoNotOptimize(b.displacement->minimize(b.cells, smoothness, {.iterations = 2, .tolerance = 0}));
  const double laplacians = 2 * row_bytes + neighbor_bytes, update = 6 * row_bytes,
               data = 3 * row_bytes + neighbor_bytes;
  count(state, b, 6 * laplacians + 3 * data + 2 * update + 4 * (9 * row_bytes + 2 * neighbor_bytes));
}

void radii(benchmark::internal::Benchmark* b) {
  b->ArgName("radius")->Arg(50)->Arg(250)->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(copy)->Apply(radii);
BENCHMARK(v_cycles)->Apply(radii);
BENCHMARK(laplacian)->Apply(radii);
BENCHMARK(data_term)->Apply(radii);
BENCHMARK(merge_samples)->Apply(radii);
BENCHMARK(reweight_curvature)->Apply(radii);
BENCHMARK(two_steps)->Apply(radii);

}  // namespace

BENCHMARK_MAIN();
