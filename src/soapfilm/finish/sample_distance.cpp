#include "soapfilm/finish/sample_distance.h"

#include <cmath>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr size_t vertices_per_task = 1024;

/// Lattice coordinates of the samples.
std::vector<Vec3d> places_of(const GridSamples& samples) {
  std::vector<Vec3d> places;
  places.reserve(samples.size());
  for (size_t b = 0; b < samples.bricks.size(); ++b)
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      places.push_back(Vec3d(samples.bricks.first_vertex(b)) + Vec3d(samples.local[s]));
  return places;
}

}  // namespace

std::vector<float> distances_to_samples(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                                        const Context& context) {
  const std::vector<Vec3d> places = places_of(samples);
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
