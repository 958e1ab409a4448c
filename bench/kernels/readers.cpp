// How fast each format of samples is read, on one thread, from the page cache: megabytes of the file per second of CPU
// time (user and system; the memory of the cloud is fresh each time), the best of several runs.
//
//   bench_readers > bench/results/readers.md
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/io.h"
#include "tests/io/e57_writer.h"
#include "tests/io/laz_files.h"
#include "tests/io/pcd_files.h"

namespace {

using namespace soapfilm;
using test::doubles;
using test::E57Writer;
using test::floats;
using test::integers;

constexpr size_t samples = 1'000'000;
constexpr int runs = 5;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Coordinates as a scanner's, one after the other.
std::vector<double> coordinates(uint64_t seed) {
  Random random(seed);
  std::vector<double> values;
  for (size_t i = 0; i < samples; ++i) values.push_back(static_cast<double>(i % 1000) * 0.01 + random.uniform());
  return values;
}

struct Files {
  Files() : folder(std::filesystem::temp_directory_path() / fmt::format("soapfilm-bench-{}", ::getpid())) {
    std::filesystem::create_directories(folder);
  }
  ~Files() { std::filesystem::remove_all(folder); }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;

  /// Reads the file some times, prints a row, removes it.
  void measure(const std::string& what, const std::string& extension, const std::string& bytes) const {
    const std::string path = (folder / ("cloud" + extension)).string();
    std::ofstream(path, std::ios::binary) << bytes;
    double best = 1e9;
    for (int run = 0; run < runs; ++run) {
      const double begin = cpu_seconds();
      const size_t size = read_points(path).size();
      if (size != samples) throw InputError(fmt::format("{}: {} samples", what, size));
      best = std::min(best, cpu_seconds() - begin);
    }
    fmt::print("| {} | {:.0f} | {:.0f} | {:.1f} |\n", what, 1e-6 * static_cast<double>(bytes.size()),
               1e-6 * static_cast<double>(bytes.size()) / best, 1e-6 * static_cast<double>(samples) / best);
    std::fflush(stdout);
  }

  std::filesystem::path folder;
};

}  // namespace

int main() {
  const std::vector<double> x = coordinates(1), y = coordinates(2), z = coordinates(3);
  const std::vector<int64_t> color(samples, 100);
  const Files files;
  fmt::print(
      "# Reading samples\n\n`bench_readers`: {} samples, one thread.\n\n"
      "| file | MB | MB per CPU second | million samples per CPU second |\n|---|---|---|---|\n",
      samples);

  std::string text, ptx = fmt::format("1000\n1000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  for (size_t i = 0; i < samples; ++i) {
    text += fmt::format("{:.6f} {:.6f} {:.6f} 0.267261 0.534522 0.801784\n", x[i], y[i], z[i]);
    ptx += fmt::format("{:.6f} {:.6f} {:.6f} 0.500000 100 110 120\n", x[i], y[i], z[i]);
  }
  files.measure("text, x y z and normals", ".xyz", text);
  files.measure("PTX, with colors", ".ptx", ptx);

  PcdFile pcd;
  std::string ply = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n",
      samples);
  std::string kitti, npy_rows;
  for (size_t i = 0; i < samples; ++i) {
    pcd.rows.push_back({x[i], y[i], z[i]});
    for (const double v : {x[i], y[i], z[i]}) {
      const std::string bytes = little_endian_bytes(static_cast<float>(v));
      ply += bytes;
      kitti += bytes;
      npy_rows += little_endian_bytes(v);
    }
    kitti += little_endian_bytes(0.5f);
  }
  files.measure("PCD, ascii", ".pcd", pcd.text(PcdCoding::ascii));
  files.measure("PCD, binary, x y z", ".pcd", pcd.text(PcdCoding::binary));
  files.measure("PCD, compressed, x y z", ".pcd", pcd.text(PcdCoding::compressed));
  files.measure("PLY, binary, x y z", ".ply", ply);
  files.measure("KITTI", ".bin", kitti);
  std::string head = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, 3), }}", samples);
  head.resize(117, ' ');
  files.measure("NumPy, double, n x 3", ".npy",
                std::string("\x93NUMPY\x01\x00", 8) + little_endian_bytes(uint16_t{118}) + head + "\n" + npy_rows);

  LasFile las;
  las.format = 3;
  for (size_t i = 0; i < samples; ++i) {
    LasPoint point;
    point.xyz = {static_cast<int32_t>(1000 * x[i]), static_cast<int32_t>(1000 * y[i]),
                 static_cast<int32_t>(1000 * z[i])};
    point.rgb = {25700, 25700, 25700};
    point.time = static_cast<double>(i);
    point.intensity = static_cast<uint16_t>(i);
    las.points.push_back(point);
  }
  files.measure("LAS, format 3 (times, colors)", ".las", las.bytes());
  files.measure("LAZ, format 3 (times, colors)", ".laz", laz_of(las.bytes()));
  las.format = 6;
  las.minor = 4;
  files.measure("LAZ, format 6 (times)", ".laz", laz_of(las.bytes()));
  las.format = 0;
  las.minor = 2;
  files.measure("LAS, format 0", ".las", las.bytes());
  files.measure("LAZ, format 0", ".laz", laz_of(las.bytes()));

  files.measure("E57, float", ".e57",
                E57Writer::file({{{floats("cartesianX", x), floats("cartesianY", y), floats("cartesianZ", z)}}}));
  files.measure("E57, double, with colors", ".e57",
                E57Writer::file({{{doubles("cartesianX", x), doubles("cartesianY", y), doubles("cartesianZ", z),
                                   integers("colorRed", color, 0, 255), integers("colorGreen", color, 0, 255),
                                   integers("colorBlue", color, 0, 255)}}}));
  std::vector<int64_t> scaled[3];
  for (size_t i = 0; i < samples; ++i) {
    scaled[0].push_back(static_cast<int64_t>(1e6 * x[i]));
    scaled[1].push_back(static_cast<int64_t>(1e6 * y[i]));
    scaled[2].push_back(static_cast<int64_t>(1e6 * z[i]));
  }
  const std::string micro = "scale=\"1e-6\" offset=\"0\"";
  files.measure("E57, scaled integers of 32 bits", ".e57",
                E57Writer::file({{{integers("cartesianX", scaled[0], INT32_MIN, INT32_MAX, micro),
                                   integers("cartesianY", scaled[1], INT32_MIN, INT32_MAX, micro),
                                   integers("cartesianZ", scaled[2], INT32_MIN, INT32_MAX, micro)}}}));
  return 0;
}
