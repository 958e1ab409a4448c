// What reading, the field, extraction and writing cost, all on one thread, in bytes per second of elapsed time beside a
// plain copy in the same run: of the file for readers and writers (from and to the page cache), of the samples or
// values that must be touched once for the others.
//
//   bench_kernels_io [--benchmark_filter=...]
#include <benchmark/benchmark.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "plain_copy.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/field/sampling.h"
#include "soapfilm/io.h"
#include "soapfilm/orient/orient.h"
#include "soapfilm/place/place.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace {

using namespace soapfilm;

constexpr size_t samples = 2'000'000;
constexpr int resolution = 512;

/// A cloud, its files and its grid, made once.
struct Case {
  Case() : folder(std::filesystem::temp_directory_path() / fmt::format("soapfilm-bench-{}", ::getpid())) {
    std::filesystem::create_directories(folder);
    make_cloud();
    binary = (folder / "binary.ply").string();
    ascii = (folder / "ascii.ply").string();
    mesh_file = (folder / "mesh.ply").string();
    write_points(binary, cloud);
    write_points(ascii, cloud, {.ascii = true, .comments = {}});
    const double voxel = voxel_of_resolution(cloud.box(), resolution, 6);
    lattice = place_lattice(cloud.box(), voxel, 6);
    OrientReport report;
    directions = orient(cloud, {}, context, report);
    sorted = sort_samples(cloud, directions, lattice, context);
    field = divergence_field(sorted, lattice.box(0), context);
    mesh = extract_isosurface(
        field.grid, field.f, [](Vec3i) { return 0.0f; }, 0.05f, lattice, context);
  }
  /// Samples of a torus, neighbors one after the other as a scanner gives them.
  void make_cloud() {
    const PointCloud random = sample_surface(*make_shape("torus"), samples, 1);
    constexpr int cells = 128;
    const Lattice coarse = place_lattice(random.box(), voxel_of_resolution(random.box(), cells, 6), 6);
    cloud.scans = random.scans;
    cloud.scans.front().sensor = Vec3d{0, 0, 10};
    for (const uint32_t s : sort_samples(random, random.normals, coarse, context).source)
      cloud.positions.push_back(static_cast<Vec3d>(static_cast<Vec3f>(random.positions[s])));
  }
  ~Case() { std::filesystem::remove_all(folder); }

  Context context{1};
  std::filesystem::path folder;
  std::string binary, ascii, mesh_file;
  PointCloud cloud;
  Lattice lattice;
  std::vector<Vec3f> directions;
  GridSamples sorted;
  SupportField field;
  Mesh mesh;
};

Case& shared() {
  static Case made;
  return made;
}

void count_bytes(benchmark::State& state, size_t bytes) {
  state.SetBytesProcessed(static_cast<int64_t>(bytes) * static_cast<int64_t>(state.iterations()));
}

/// Bytes read and written; the arrays are 8 times a last cache of 64 MiB.
void copy(benchmark::State& state) {
  const size_t count = (size_t{512} << 20) / sizeof(float);
  AlignedArray<float> from(count), to(count);
  std::fill_n(from.data(), count, 1.0f);
  std::fill_n(to.data(), count, 2.0f);  // both have pages of their own
  for (auto _ : state) {
    plain_copy(from.data(), to.data(), count);
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  count_bytes(state, 2 * count * sizeof(float));
}

void read_file(benchmark::State& state, const std::string& path) {
  for (auto _ : state) benchmark::DoNotOptimize(read_points(path));
  count_bytes(state, std::filesystem::file_size(path));
}
void read_binary_ply(benchmark::State& state) { read_file(state, shared().binary); }
void read_ascii_ply(benchmark::State& state) { read_file(state, shared().ascii); }

void measure_density(benchmark::State& state) {
  Case& c = shared();
  for (auto _ : state) benchmark::DoNotOptimize(measure_sampling(c.cloud, c.context));
  count_bytes(state, samples * sizeof(Vec3d));
}

void orient_samples(benchmark::State& state) {
  Case& c = shared();
  OrientReport report;
  for (auto _ : state) benchmark::DoNotOptimize(orient(c.cloud, {}, c.context, report));
  count_bytes(state, samples * (sizeof(Vec3d) + sizeof(Vec3f)));
}

void sort_by_brick(benchmark::State& state) {
  Case& c = shared();
  for (auto _ : state) benchmark::DoNotOptimize(sort_samples(c.cloud, c.directions, c.lattice, c.context));
  count_bytes(state, samples * (sizeof(Vec3d) + 3 * sizeof(Vec3f) + sizeof(uint32_t)));
}

/// Splat, smoothing and divergence.
void data_term(benchmark::State& state) {
  Case& c = shared();
  for (auto _ : state) benchmark::DoNotOptimize(divergence_field(c.sorted, c.lattice.box(0), c.context));
  count_bytes(state, samples * 2 * sizeof(Vec3f) + c.field.f.bytes());
  state.counters["bricks"] = static_cast<double>(c.field.grid.size());
}

void extract(benchmark::State& state) {
  Case& c = shared();
  for (auto _ : state)
    benchmark::DoNotOptimize(extract_isosurface(
        c.field.grid, c.field.f, [](Vec3i) { return 0.0f; }, 0.05f, c.lattice, c.context));
  count_bytes(state,
              c.field.f.bytes() + c.mesh.vertices.size() * sizeof(Vec3d) + c.mesh.triangles.size() * sizeof(Triangle));
  state.counters["triangles"] = static_cast<double>(c.mesh.triangles.size());
}

void write_binary_ply(benchmark::State& state) {
  Case& c = shared();
  for (auto _ : state)
    write_mesh(c.mesh_file, c.mesh, {.coordinate_precision = 1e-3 * c.lattice.voxel, .comments = {}});
  count_bytes(state, std::filesystem::file_size(c.mesh_file));
}

/// Rates are those of the elapsed time.
void elapsed(benchmark::internal::Benchmark* b) { b->Unit(benchmark::kMillisecond)->UseRealTime(); }

BENCHMARK(copy)->Apply(elapsed);
BENCHMARK(read_binary_ply)->Apply(elapsed);
BENCHMARK(read_ascii_ply)->Apply(elapsed);
BENCHMARK(measure_density)->Apply(elapsed);
BENCHMARK(orient_samples)->Apply(elapsed);
BENCHMARK(sort_by_brick)->Apply(elapsed);
BENCHMARK(data_term)->Apply(elapsed);
BENCHMARK(extract)->Apply(elapsed);
BENCHMARK(write_binary_ply)->Apply(elapsed);

}  // namespace

BENCHMARK_MAIN();
