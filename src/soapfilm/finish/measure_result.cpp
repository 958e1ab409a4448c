#include "soapfilm/finish/measure_result.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/border_edges.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/finish/hole_list.h"
#include "soapfilm/finish/nearest_sample.h"

namespace soapfilm {

namespace {

std::vector<HoleFacts> find_holes(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, double density,
                                  const Context& context) {
  constexpr size_t per_task = 4096;
  constexpr double beyond = 1.01;  // of the distance: how far samples are searched
  const double voxels = unseen_distance(density, lattice) / lattice.voxel;
  std::vector<uint8_t> unseen(mesh.vertices.size());
  parallel_for(context, unseen.size(), per_task, [&](size_t v) {
    unseen[v] = distance_to_samples(samples, lattice.to_lattice(mesh.vertices[v]), voxels, beyond * voxels) > voxels;
  });
  const bool all = std::all_of(unseen.begin(), unseen.end(), [](uint8_t u) { return u != 0; });
  return all ? std::vector<HoleFacts>() : list_holes(mesh, unseen, {});
}

}  // namespace

double unseen_distance(double density, const Lattice& lattice) {
  constexpr double spacings = 3;
  const double spacing = density > 0 ? 1 / std::sqrt(density) : 1;
  return spacings * std::max(1.0, spacing) * lattice.voxel;
}

MeasureReport measure_result(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, double density,
                             const std::optional<TrimReport>& trim, const FillDifference& fill,
                             const Context& context) {
  MeasureReport out;
  out.area = mesh.area();
  out.holes = trim ? trim->holes : find_holes(mesh, samples, lattice, density, context);
  for (const HoleFacts& hole : out.holes)
    if (!hole.cut) out.filled_area += hole.area;
  if (!is_closed(mesh)) return out;
  out.volume = std::abs(mesh.volume());
  if (fill.flat) {
    out.volume_flat = out.volume;
    return out;
  }
  out.volume_smooth = out.volume;
  out.volume_flat = *out.volume - static_cast<double>(fill.gained) * std::pow(lattice.voxel, 3);
  return out;
}

}  // namespace soapfilm
