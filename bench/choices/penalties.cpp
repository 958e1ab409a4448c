// Which robust penalty the refinement should have: errors with each, over those with the default. Prints a Markdown
// table.
//
//   penalties [MESH...]
//
// The built-in shapes and the given meshes, 128 voxels long: even samples, one per voxel^2, directions towards the
// scanner, and range scans. Error: mean distance from the truth to the mesh.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/run.h"
#include "tools/evaluate/evaluate.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace {

using namespace soapfilm;

constexpr int voxels_along = 128;
constexpr size_t points = 100'000;

struct Condition {
  const char* title;
  double noise;     // standard deviation, voxels
  double outliers;  // share of the samples
  bool scans;       // instead of even samples: each shifted by half a voxel
};

constexpr Condition conditions[] = {{"no noise", 0, 0, false},
                                    {"noise of 1/20 voxel", 1.0 / 20, 0, false},
                                    {"of 1/3", 1.0 / 3, 0, false},
                                    {"of 1/2", 1.0 / 2, 0, false},
                                    {"10 % outliers", 0, 0.1, false},
                                    {"10 %, noise of 1/20", 1.0 / 20, 0.1, false},
                                    {"10 %, noise of 1/3", 1.0 / 3, 0.1, false},
                                    {"scans misaligned by 1/2 voxel", 0, 0, true}};

struct Candidate {
  const char* title;
  Penalty penalty;
  double scale_of_noise;
};

// The default first.
constexpr Candidate candidates[] = {{"Tukey, scale of 2.5 noise", Penalty::tukey, 2.5},
                                    {"Tukey, 1", Penalty::tukey, 1},
                                    {"Geman-McClure, 5", Penalty::geman_mcclure, 5},
                                    {"Geman-McClure, 2.5", Penalty::geman_mcclure, 2.5},
                                    {"Geman-McClure, 1", Penalty::geman_mcclure, 1},
                                    {"Huber, 2.5", Penalty::huber, 2.5},
                                    {"Huber, 1", Penalty::huber, 1},
                                    {"least squares", Penalty::least_squares, 1}};

PointCloud measure(const Surface& surface, double voxel, const Condition& condition, const Context& context) {
  ScannerParams scanner;
  scanner.step = voxel;
  scanner.misalignment = condition.scans ? voxel / 2 : 0;
  if (condition.scans) return virtual_scan(surface, scanner, context).cloud;
  SamplingParams sampling;
  sampling.count = static_cast<size_t>(std::lround(surface.tessellate(voxel / 100).area() / (voxel * voxel)));
  sampling.noise = condition.noise * voxel;
  sampling.outliers = condition.outliers;
  sampling.sensors = scanner_positions(surface.box(), scanner);
  return sample_surface(surface, sampling, context);
}

/// Mean distance from the truth to the mesh, voxels.
double error(const PointCloud& cloud, const Surface& truth, double voxel, const Candidate& candidate,
             const Context& context) {
  ReconstructParams params;
  params.place.voxel = voxel;
  Experiment experiment;
  experiment.robust.penalty = candidate.penalty;
  experiment.robust.scale_of_noise = candidate.scale_of_noise;
  const Mesh mesh = run(cloud, nullptr, params, context, experiment).mesh;
  EvaluationOptions options;
  options.points = points;
  return evaluate(mesh, truth, options, context).truth_to_mesh.distance.mean / voxel;
}

struct Object {
  std::string name;
  std::shared_ptr<const Surface> surface;
};

std::vector<Object> objects(int files, char** file, const Context& context) {
  std::vector<Object> list;
  for (const char* name : {"sphere", "torus", "plate", "sheets", "knot", "part"})
    list.push_back({name, make_shape(name)});
  for (int i = 0; i < files; ++i)
    list.push_back(
        {std::filesystem::path(file[i]).stem().string(), std::make_shared<MeshSurface>(read_mesh(file[i]), context)});
  return list;
}

}  // namespace

int main(int argc, char** argv) {
  const Context context(0);
  const std::vector<Object> all = objects(argc - 1, argv + 1, context);
  fmt::print("Errors over those of the default, geometric mean over");
  for (const Object& object : all) fmt::print(" {}", object.name);
  fmt::print(" (least to largest).\n\n| |");
  for (const Condition& condition : conditions) fmt::print(" {} |", condition.title);
  fmt::print("\n|---|");
  std::vector<std::string> cells(std::size(candidates));
  for (const Condition& condition : conditions) {
    fmt::print("---|");
    std::vector<std::vector<double>> ratios(std::size(candidates));
    for (const Object& object : all) {
      const double voxel = object.surface->box().longest() / voxels_along;
      const PointCloud cloud = measure(*object.surface, voxel, condition, context);
      double first = 0;
      for (size_t c = 0; c < std::size(candidates); ++c) {
        const double mean = error(cloud, *object.surface, voxel, candidates[c], context);
        if (c == 0) first = mean;
        ratios[c].push_back(mean / first);
      }
    }
    for (size_t c = 0; c < std::size(candidates); ++c) {
      double logs = 0;
      for (const double ratio : ratios[c]) logs += std::log(ratio);
      const auto [least, largest] = std::minmax_element(ratios[c].begin(), ratios[c].end());
      cells[c] += fmt::format(" {:.2f} ({:.2f} to {:.2f}) |", std::exp(logs / static_cast<double>(ratios[c].size())),
                              *least, *largest);
    }
  }
  fmt::print("\n");
  for (size_t c = 0; c < std::size(candidates); ++c) fmt::print("| {} |{}\n", candidates[c].title, cells[c]);
}
