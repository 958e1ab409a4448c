// The remarks at the end of the paper, measured: equation (8) written as its reviewer feared, and what each of his
// suggestions gains. Prints a Markdown table. Usage: bench_remarks INPUT RESOLUTION
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/io.h"
#include "soapfilm/orient/orient.h"
#include "soapfilm/solve/sor.h"

namespace {

using namespace soapfilm;

constexpr float epsilon2 = 0.001f * 0.001f;
constexpr float omega = 1.85f;
constexpr int iterations = 10;  // five renewals of the diffusivity

using Cube = std::vector<std::vector<std::vector<float>>>;

float diffusivity(float dx, float dy, float dz) { return 1 / std::sqrt(dx * dx + dy * dy + dz * dz + epsilon2); }

float relaxed(float u, float weighted, float weights, float scale_f, float lambda) {
  const float v = (1 - omega) * u + omega * (lambda * weighted + scale_f) / (lambda * weights);
  return std::clamp(v, 0.0f, 1.0f);
}

/// An array of arrays of arrays, and N(i) walked as a list whose members are looked up one by one.
struct Nested {
  Cube u, g, f;
  Vec3i n;

  Nested(const DenseField<float>& data) : n(data.size()) {
    u = Cube(n.z, std::vector<std::vector<float>>(n.y, std::vector<float>(n.x)));
    g = f = u;
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) f[z][y][x] = data.row(y, z)[x];
  }
  void renew() {
    for (int z = 0; z + 1 < n.z; ++z)
      for (int y = 0; y + 1 < n.y; ++y)
        for (int x = 0; x + 1 < n.x; ++x)
          g[z][y][x] =
              diffusivity(u[z][y][x + 1] - u[z][y][x], u[z][y + 1][x] - u[z][y][x], u[z + 1][y][x] - u[z][y][x]);
  }
  void sweep(float lambda) {
    static const std::vector<Vec3i> neighbors = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
    for (int z = 1; z + 1 < n.z; ++z)
      for (int y = 1; y + 1 < n.y; ++y)
        for (int x = 1; x + 1 < n.x; ++x) {
          float weighted = 0, weights = 0;
          for (const Vec3i& d : neighbors) {
            const float gij = (g[z][y][x] + g[z + d.z][y + d.y][x + d.x]) / 2;
            weighted += gij * u[z + d.z][y + d.y][x + d.x];
            weights += gij;
          }
          u[z][y][x] = relaxed(u[z][y][x], weighted, weights, f[z][y][x], lambda);
        }
  }
  float value(int x, int y, int z) const { return u[z][y][x]; }
};

/// One flat array; every access maps (x, y, z) to its place.
struct Mapped {
  std::vector<float> u, g, f;
  Vec3i n;

  Mapped(const DenseField<float>& data) : f(data.data(), data.data() + data.count()), n(data.size()) {
    u.resize(f.size());
    g.resize(f.size());
  }
  size_t at(int x, int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(n.y) + static_cast<size_t>(y)) * static_cast<size_t>(n.x) +
           static_cast<size_t>(x);
  }
  void renew() {
    for (int z = 0; z + 1 < n.z; ++z)
      for (int y = 0; y + 1 < n.y; ++y)
        for (int x = 0; x + 1 < n.x; ++x)
          g[at(x, y, z)] = diffusivity(u[at(x + 1, y, z)] - u[at(x, y, z)], u[at(x, y + 1, z)] - u[at(x, y, z)],
                                       u[at(x, y, z + 1)] - u[at(x, y, z)]);
  }
  void sweep(float lambda) {
    static const std::vector<Vec3i> neighbors = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
    for (int z = 1; z + 1 < n.z; ++z)
      for (int y = 1; y + 1 < n.y; ++y)
        for (int x = 1; x + 1 < n.x; ++x) {
          float weighted = 0, weights = 0;
          for (const Vec3i& d : neighbors) {
            const float gij = (g[at(x, y, z)] + g[at(x + d.x, y + d.y, z + d.z)]) / 2;
            weighted += gij * u[at(x + d.x, y + d.y, z + d.z)];
            weights += gij;
          }
          u[at(x, y, z)] = relaxed(u[at(x, y, z)], weighted, weights, f[at(x, y, z)], lambda);
        }
  }
  float value(int x, int y, int z) const { return u[at(x, y, z)]; }
};

/// The same array with constant neighbor offsets, N(i) written out.
struct Offsets : Mapped {
  using Mapped::Mapped;
  void renew() {
    const size_t sy = static_cast<size_t>(n.x), sz = sy * static_cast<size_t>(n.y);
    for (int z = 0; z + 1 < n.z; ++z)
      for (int y = 0; y + 1 < n.y; ++y)
        for (size_t i = at(0, y, z), end = i + sy - 1; i < end; ++i)
          g[i] = diffusivity(u[i + 1] - u[i], u[i + sy] - u[i], u[i + sz] - u[i]);
  }
  /// divided: f / lambda instead of lambda twice per vertex.
  void run(size_t begin, size_t end, float lambda) {
    const size_t sy = static_cast<size_t>(n.x), sz = sy * static_cast<size_t>(n.y);
    for (size_t i = begin; i < end; ++i) {
      const float c = g[i];
      const float g0 = (c + g[i - 1]) / 2, g1 = (c + g[i + 1]) / 2, g2 = (c + g[i - sy]) / 2, g3 = (c + g[i + sy]) / 2,
                  g4 = (c + g[i - sz]) / 2, g5 = (c + g[i + sz]) / 2;
      const float weighted =
          g0 * u[i - 1] + g1 * u[i + 1] + g2 * u[i - sy] + g3 * u[i + sy] + g4 * u[i - sz] + g5 * u[i + sz];
      u[i] = relaxed(u[i], weighted, g0 + g1 + g2 + g3 + g4 + g5, f[i], lambda);
    }
  }
  void sweep(float lambda) {
    for (int z = 1; z + 1 < n.z; ++z)
      for (int y = 1; y + 1 < n.y; ++y) run(at(1, y, z), at(n.x - 1, y, z), lambda);
  }
};

struct Divided : Offsets {
  Divided(const DenseField<float>& data, float lambda) : Offsets(data) {
    for (float& value : f) value /= lambda;
  }
  void run_divided(size_t begin, size_t end) {
    const size_t sy = static_cast<size_t>(n.x), sz = sy * static_cast<size_t>(n.y);
    for (size_t i = begin; i < end; ++i) {
      const float c = g[i];
      // Twice every weight, in the numerator and in the denominator alike.
      const float g0 = c + g[i - 1], g1 = c + g[i + 1], g2 = c + g[i - sy], g3 = c + g[i + sy], g4 = c + g[i - sz],
                  g5 = c + g[i + sz];
      const float weighted =
          g0 * u[i - 1] + g1 * u[i + 1] + g2 * u[i - sy] + g3 * u[i + sy] + g4 * u[i - sz] + g5 * u[i + sz];
      u[i] = std::clamp((1 - omega) * u[i] + omega * (weighted + 2 * f[i]) / (g0 + g1 + g2 + g3 + g4 + g5), 0.0f, 1.0f);
    }
  }
  void sweep(float) {
    for (int z = 1; z + 1 < n.z; ++z)
      for (int y = 1; y + 1 < n.y; ++y) run_divided(at(1, y, z), at(n.x - 1, y, z));
  }
};

/// Cubes of 8^3 vertices with a bit each: those that are 0 with all their neighbors and have no data stay so.
struct Skipping : Divided {
  std::vector<bool> active;
  Vec3i cubes;

  Skipping(const DenseField<float>& data, float lambda)
      : Divided(data, lambda), cubes{(n.x + 7) / 8, (n.y + 7) / 8, (n.z + 7) / 8} {
    active.resize(static_cast<size_t>(cubes.x) * static_cast<size_t>(cubes.y) * static_cast<size_t>(cubes.z));
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x)
          if (f[at(x, y, z)] != 0) active[cube(x / 8, y / 8, z / 8)] = true;
  }
  size_t cube(int x, int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(cubes.y) + static_cast<size_t>(y)) *
               static_cast<size_t>(cubes.x) +
           static_cast<size_t>(x);
  }
  /// u can have crept at most into the neighbors of active cubes: they join.
  void spread() {
    const std::vector<bool> before = active;
    for (int z = 0; z < cubes.z; ++z)
      for (int y = 0; y < cubes.y; ++y)
        for (int x = 0; x < cubes.x; ++x) {
          if (!before[cube(x, y, z)]) continue;
          bool empty = true;
          for (int k = z * 8; k < std::min(n.z, z * 8 + 8) && empty; ++k)
            for (int j = y * 8; j < std::min(n.y, y * 8 + 8) && empty; ++j)
              for (int i = x * 8; i < std::min(n.x, x * 8 + 8) && empty; ++i) empty = u[at(i, j, k)] == 0;
          if (empty) continue;
          for (int d = 0; d < 6; ++d) {
            const int step = d % 2 ? 1 : -1;
            const Vec3i c{x + (d / 2 == 0) * step, y + (d / 2 == 1) * step, z + (d / 2 == 2) * step};
            if (c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < cubes.x && c.y < cubes.y && c.z < cubes.z)
              active[cube(c.x, c.y, c.z)] = true;
          }
        }
  }
  void renew() {
    spread();
    Offsets::renew();
  }
  void sweep(float) {
    for (int z = 1; z + 1 < n.z; ++z)
      for (int y = 1; y + 1 < n.y; ++y)
        for (int c = 0; c < cubes.x; ++c)
          if (active[cube(c, y / 8, z / 8)])
            run_divided(at(std::max(1, c * 8), y, z), at(std::min(n.x - 1, c * 8 + 8), y, z));
  }
};

struct Measured {
  double nanoseconds;  // per vertex and iteration
  double share;        // vertices inside, for the eye
};

template <class Solver>
Measured measure(Solver solver, float lambda) {
  const std::clock_t begin = std::clock();
  for (int i = 0; i < iterations; ++i) {
    if (i % 2 == 0) solver.renew();
    solver.sweep(lambda);
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const Vec3i n = solver.n;
  const double vertices = static_cast<double>(n.x) * n.y * n.z;
  double sum = 0;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) sum += solver.value(x, y, z);
  return {1e9 * seconds / vertices / iterations, sum};
}

/// The solver of the library, its energy at each iteration included.
Measured measure_tv_sor(const LevelBox& box, const SupportField& field, float lambda) {
  DenseField<float> u(box);
  SorParams params;
  params.tolerance = 0;
  params.max_iterations = iterations;
  const std::clock_t begin = std::clock();
  relax_sor(u, box, lambda, field, params, Context(1));
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const double sum = std::accumulate(u.data(), u.data() + u.count(), 0.0);
  return {1e9 * seconds / static_cast<double>(u.count()) / iterations, sum};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return fmt::print(stderr, "usage: bench_remarks INPUT RESOLUTION\n"), 2;
  const PointCloud cloud = read_points(argv[1]);
  const Context context(1);
  OrientReport oriented;
  const auto directions = orient(cloud, {}, context, oriented);
  const Lattice lattice = place_lattice(cloud.box(), voxel_of_resolution(cloud.box(), std::atoi(argv[2]), 6), 6);
  const LevelBox box = lattice.box(0);
  const SupportField field = divergence_field(sort_samples(cloud, directions, lattice, context), box, context);
  DenseField<float> data(box);
  for (size_t b = 0; b < field.grid.size(); ++b)
    for_each_run(data, field.grid.coord(b), [&](float* row, int x, int y, int z, int n) {
      std::copy_n(field.f.brick(b) + brick_offset(x, y, z), n, row);
    });
  const float lambda = 0.01f;

  struct Row {
    const char* remark;
    std::function<Measured()> run;
  };
  const std::vector<Row> rows = {
      {"3D array of arrays, neighbors from a list", [&] { return measure(Nested(data), lambda); }},
      {"one-dimensional array, (x, y, z) mapped at each access", [&] { return measure(Mapped(data), lambda); }},
      {"constant neighbor offsets", [&] { return measure(Offsets(data), lambda); }},
      {"lambda divided out", [&] { return measure(Divided(data, lambda), lambda); }},
      {"empty cubes skipped by a bitmap", [&] { return measure(Skipping(data, lambda), lambda); }},
      {"all of it and vectors, two iterations in one pass: tv-sor",
       [&] { return measure_tv_sor(box, field, lambda); }}};
  constexpr int repeats = 5;
  std::vector<std::vector<double>> times(rows.size());
  std::vector<double> sums(rows.size());
  for (int r = 0; r < repeats; ++r)
    for (size_t i = 0; i < rows.size(); ++i) {
      const Measured m = rows[i].run();
      times[i].push_back(m.nanoseconds);
      sums[i] = m.share;
    }
  const Vec3i size = lattice.to_world_axes(lattice.size);
  fmt::print(
      "| equation (8), {} x {} x {}, one thread | CPU ns per vertex and iteration | of the first | sum of u |\n"
      "|---|---|---|---|\n",
      size.x, size.y, size.z);
  for (size_t i = 0; i < rows.size(); ++i) {
    std::sort(times[i].begin(), times[i].end());
    std::sort(times[0].begin(), times[0].end());
    fmt::print("| {} | {:.2f} | {:.2f} | {:.6g} |\n", rows[i].remark, times[i][repeats / 2],
               times[i][repeats / 2] / times[0][repeats / 2], sums[i]);
  }
}
