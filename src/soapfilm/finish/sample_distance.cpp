#include "soapfilm/finish/sample_distance.h"

#include <cmath>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr size_t vertices_per_task = 1024;

}  // namespace

std::vector<float> distances_to_samples(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                                        const Context& context) {
  const std::vector<Vec3d> places = lattice_positions(samples);
  const KdTree tree(places);
  std::vector<float> distances(mesh.vertices.size());
  parallel_for(context, distances.size(), vertices_per_task, [&](size_t v) {
    const Vec3d at = lattice.to_lattice(mesh.vertices[v]);
    uint32_t nearest = 0;
    double squared = 0;
    tree->knnSearch(&at.x, 1, &nearest, &squared);
    distances[v] = static_cast<float>(std::sqrt(squared) * lattice.voxel);
  });
  return distances;
}

}  // namespace soapfilm
