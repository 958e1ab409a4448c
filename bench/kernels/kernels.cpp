// The solver's kernels beside a plain copy in the same run, in bytes per second of elapsed time: what a sweep reads and
// writes is the floor.
//
//   bench_kernels [--benchmark_filter=...]
//
// A level of BRICKS bricks (environment SOAPFILM_BENCH_BRICKS, default 32768: 590 MB), with values everywhere. Sweeps
// begin from the same values in each iteration, and say which share of the rows they moved: rows at rest cost nothing.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "plain_copy.h"
#include "soapfilm/core/parallel.h"
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

/// u and p of a level.
struct State {
  Field<float> u;
  Field<float, 3> p;
};

/// A whole box with values everywhere.
struct NoisyLevel {
  explicit NoisyLevel(const Context& context) {
    const char* wanted = std::getenv("SOAPFILM_BENCH_BRICKS");
    const int side = static_cast<int>(std::cbrt(wanted ? std::stod(wanted) : 32768.0));
    const Vec3i bricks{side, side, side};
    const BrickMask everywhere = BrickMask::whole(bricks);
    const LevelBox box{0, {1, 1, 1}, bricks * brick_side - Vec3i{2, 2, 2}, bricks};
    support = BrickGrid(everywhere, context);
    f = Field<float>(support);
    level = make_level(box, lambda, everywhere, support, f, context);
    parallel_for(context, support.size(), 64, [&](size_t b) {
      for (size_t i = 0; i < brick_volume; ++i) {
        const uint64_t key = 8 * (b * brick_volume + i);
        f.brick(b)[i] = 0.1f * (noise(key) - 0.5f);
        level.u.brick(b)[i] = noise(key + 1);
        for (int axis = 0; axis < 3; ++axis)
          level.p.brick(b, axis)[i] = lambda * (noise(key + 2 + static_cast<uint64_t>(axis)) - 0.5f);
      }
    });
  }

  double vertices() const { return static_cast<double>(level.grid.vertices()); }

  /// All that a sweep writes.
  State state(const Context& context) const {
    State kept{Field<float>(level.grid), Field<float, 3>(level.grid)};
    copy_state(level, kept, context);
    return kept;
  }
  void restore(const State& kept, const Context& context) { copy_state(kept, level, context); }

  template <class From, class To>
  static void copy_state(const From& from, To& to, const Context& context) {
    parallel_for(context, from.u.bricks(), 256, [&](size_t b) {
      plain_copy(from.u.brick(b), to.u.brick(b), brick_volume);
      plain_copy(from.p.brick(b), to.p.brick(b), 3 * brick_volume);
    });
  }

  BrickGrid support;
  Field<float> f;
  Level level;
};

/// Made once; benchmarks leave it as it is.
NoisyLevel& shared() {
  static NoisyLevel made{Context()};
  return made;
}

/// Shares of the rows of eight vertices whose u and whose p a sweep moved, on the mean of the first sweeps. A row that
/// moves was stepped, so at least as many were at work.
struct Moved {
  double u = 0, p = 0;
};

Moved moved_by(int sweeps) {
  const Context context;
  NoisyLevel& noisy = shared();
  const State start = noisy.state(context);
  State before = noisy.state(context);
  Sweeper sweeper(noisy.level, context);
  const size_t rows = noisy.level.grid.size() * brick_area;
  size_t u_rows = 0, p_rows = 0;
  for (int k = 0; k < sweeps; ++k) {
    sweeper.sweep(steps);
    for (size_t row = 0; row < rows; ++row) {
      const size_t b = row / brick_area, first = brick_side * (row % brick_area);
      const auto differ = [&](const float* x, const float* y) {
        return !std::equal(x + first, x + first + brick_side, y + first);
      };
      u_rows += differ(noisy.level.u.brick(b), before.u.brick(b));
      bool p = false;
      for (int axis = 0; axis < 3; ++axis) p = p || differ(noisy.level.p.brick(b, axis), before.p.brick(b, axis));
      p_rows += p;
    }
    NoisyLevel::copy_state(noisy.level, before, context);
  }
  noisy.restore(start, context);
  const double all = static_cast<double>(rows) * sweeps;
  return {static_cast<double>(u_rows) / all, static_cast<double>(p_rows) / all};
}

void count(benchmark::State& state, double vertices, double bytes_per_vertex) {
  state.SetBytesProcessed(static_cast<int64_t>(static_cast<double>(state.iterations()) * vertices * bytes_per_vertex));
  state.counters["ns_per_vertex"] =
      benchmark::Counter(vertices * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// What a sweep writes, read from one place and written to another: 268 MB each.
void copy(benchmark::State& state) {
  const Context context(static_cast<int>(state.range(0)));
  const NoisyLevel& noisy = shared();
  State target = noisy.state(context);  // its pages are there from now on
  for (auto _ : state) {
    NoisyLevel::copy_state(noisy.level, target, context);
    benchmark::ClobberMemory();
  }
  count(state, noisy.vertices(), 4 * 8);
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

/// The first sweeps of a new sweeper, all of them of one pass over the tiles.
template <int times>
void sweeps(benchmark::State& state) {
  const Context context(static_cast<int>(state.range(0)));
  NoisyLevel& noisy = shared();
  static const Moved moved = moved_by(times);
  const State start = noisy.state(context);
  for (auto _ : state) {
    state.PauseTiming();
    auto sweeper = std::make_unique<Sweeper>(noisy.level, context);
    state.ResumeTiming();
    sweeper->sweep(steps, times);
    state.PauseTiming();
    sweeper.reset();
    noisy.restore(start, context);
    state.ResumeTiming();
  }
  count(state, times * noisy.vertices(), Sweeper::bytes_per_vertex);
  state.counters["u_rows_moved"] = moved.u;
  state.counters["p_rows_moved"] = moved.p;
}
void one_sweep(benchmark::State& state) { sweeps<1>(state); }
void eight_sweeps(benchmark::State& state) { sweeps<8>(state); }

void energy(benchmark::State& state) {
  const Context context(static_cast<int>(state.range(0)));
  const NoisyLevel& noisy = shared();
  for (auto _ : state) benchmark::DoNotOptimize(evaluate_energy(noisy.level, {}, context));
  count(state, noisy.vertices(), evaluated_bytes_per_vertex);
}

void threads(benchmark::internal::Benchmark* b) {
  // Rates are those of the elapsed time; the CPU time beside it is that of all threads.
  b->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
}

BENCHMARK(copy)->Apply(threads);
BENCHMARK(chase)->ArgNames({"lines", "apart"})->ArgsProduct({{2048, 4096, 8192, 32768}, {0, 1}});
BENCHMARK(one_sweep)->Apply(threads);
BENCHMARK(eight_sweeps)->Apply(threads);
BENCHMARK(energy)->Apply(threads);

}  // namespace

BENCHMARK_MAIN();
