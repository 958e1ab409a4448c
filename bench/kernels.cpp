// The solver's kernels beside a copy in the same run, in bytes per second: what a sweep reads and writes is the floor.
//
//   kernels [--benchmark_filter=...]
//
// A level of BRICKS bricks (environment SOAPFILM_BENCH_BRICKS, default 32768: 590 MB), every row of it at work.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/sweep.h"

namespace {

using namespace soapfilm;

constexpr float lambda = 0.02f;
constexpr StepSizes steps{.sigma = 1.4f * lambda, .tau = 1 / (12 * 1.4f * lambda)};
constexpr double evaluated_bytes_per_vertex = 4 * 5;  // u, p and f in

/// A number in [0, 1) that looks random: a function of its place.
float noise(uint64_t i) {
  i = (i + 0x9E3779B97F4A7C15u) * 0xBF58476D1CE4E5B9u;
  i = (i ^ i >> 27) * 0x94D049BB133111EBu;
  return static_cast<float>(i >> 40) * 0x1p-24f;
}

/// A whole box with values everywhere.
struct NoisyLevel {
  explicit NoisyLevel(const Parallel& parallel) {
    const char* wanted = std::getenv("SOAPFILM_BENCH_BRICKS");
    const int side = static_cast<int>(std::cbrt(wanted ? std::stod(wanted) : 32768.0));
    const Vec3i bricks{side, side, side};
    const BrickMask everywhere = BrickMask::whole(bricks);
    const LevelBox box{0, {1, 1, 1}, bricks * brick_side - Vec3i{2, 2, 2}, bricks};
    support = BrickGrid(everywhere, parallel);
    f = Field<float>(support);
    level = make_level(box, lambda, everywhere, support, f, parallel);
    parallel.for_each(support.size(), 64, [&](size_t b) {
      for (size_t i = 0; i < brick_volume; ++i) {
        const uint64_t key = 8 * (b * brick_volume + i);
        f.brick(b)[i] = 0.1f * (noise(key) - 0.5f);
        level.u.brick(b)[i] = noise(key + 1);
        for (int axis = 0; axis < 3; ++axis)
          level.p.brick(b, axis)[i] = lambda * (noise(key + 2 + static_cast<uint64_t>(axis)) - 0.5f);
      }
    });
  }

  BrickGrid support;
  Field<float> f;
  Level level;
};

void count(benchmark::State& state, double vertices, double bytes_per_vertex) {
  state.SetBytesProcessed(static_cast<int64_t>(static_cast<double>(state.iterations()) * vertices * bytes_per_vertex));
  state.counters["ns_per_vertex"] =
      benchmark::Counter(vertices * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Bytes read and written, as of a sweep.
void copy(benchmark::State& state) {
  const Parallel parallel(static_cast<int>(state.range(0)));
  NoisyLevel noisy(parallel);
  Field<float, 3> target(noisy.level.grid);
  const size_t bricks = noisy.level.grid.size();
  const auto copy_all = [&] {
    parallel.for_each(bricks, 256, [&](size_t b) {
      std::memcpy(target.brick(b), noisy.level.p.brick(b), 3 * brick_volume * sizeof(float));
    });
    benchmark::ClobberMemory();
  };
  copy_all();  // the target's pages are there from now on
  for (auto _ : state) copy_all();
  count(state, static_cast<double>(noisy.level.grid.vertices()), 4 * 6);
}

/// One load after the other, each from where the last one said: nanoseconds per load of `lines` lines of a large array,
/// side by side or a page of 4 kB apart. What the second takes longer is the address cache's.
void chase(benchmark::State& state) {
  constexpr size_t line = 64, page = 4096;
  const auto lines = static_cast<size_t>(state.range(0));
  const size_t stride = state.range(1) != 0 ? page + line : line;  // not all of them in one set of the cache
  AlignedArray<char> memory(lines * stride);
  std::vector<size_t> order(lines);
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [](size_t a, size_t b) { return noise(a) < noise(b); });
  const auto at = [&](size_t k) { return reinterpret_cast<char**>(memory.data() + order[k % lines] * stride); };
  for (size_t k = 0; k < lines; ++k) *at(k) = reinterpret_cast<char*>(at(k + 1));
  char* here = reinterpret_cast<char*>(at(0));
  for (auto _ : state)
    for (size_t k = 0; k < lines; ++k) here = *reinterpret_cast<char**>(here);
  benchmark::DoNotOptimize(here);
  state.counters["ns_per_load"] = benchmark::Counter(
      static_cast<double>(lines) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// The first sweeps of each sweeper, all of them of one pass over the tiles: hardly a row rests.
void sweeps(benchmark::State& state, int times) {
  const Parallel parallel(static_cast<int>(state.range(0)));
  NoisyLevel noisy(parallel);
  for (auto _ : state) {
    state.PauseTiming();
    auto sweeper = std::make_unique<Sweeper>(noisy.level, parallel);
    state.ResumeTiming();
    sweeper->sweep(steps, times);
    state.PauseTiming();
    sweeper.reset();
    state.ResumeTiming();
  }
  count(state, times * static_cast<double>(noisy.level.grid.vertices()), Sweeper::bytes_per_vertex);
}

void energy(benchmark::State& state) {
  const Parallel parallel(static_cast<int>(state.range(0)));
  NoisyLevel noisy(parallel);
  for (auto _ : state) benchmark::DoNotOptimize(evaluate_energy(noisy.level, {}, parallel));
  count(state, static_cast<double>(noisy.level.grid.vertices()), evaluated_bytes_per_vertex);
}

void threads(benchmark::internal::Benchmark* b) {
  b->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
}

BENCHMARK(copy)->Apply(threads);
BENCHMARK(chase)->ArgNames({"lines", "apart"})->ArgsProduct({{2048, 4096, 8192, 32768}, {0, 1}});
BENCHMARK_CAPTURE(sweeps, one, 1)->Apply(threads);
BENCHMARK_CAPTURE(sweeps, eight, 8)->Apply(threads);
BENCHMARK(energy)->Apply(threads);

}  // namespace

BENCHMARK_MAIN();
