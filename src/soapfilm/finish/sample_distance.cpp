#include "soapfilm/finish/sample_distance.h"

#include <cmath>
#include <nanoflann.hpp>

namespace soapfilm {

namespace {

constexpr size_t vertices_per_task = 1024;

/// Lattice coordinates of the samples, as nanoflann asks for them.
struct Places {
  std::vector<Vec3d> points;

  explicit Places(const GridSamples& samples) {
    points.reserve(samples.size());
    for (size_t b = 0; b < samples.bricks.size(); ++b)
      for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
        points.push_back(Vec3d(samples.bricks.first_vertex(b)) + Vec3d(samples.local[s]));
  }

  size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(size_t index, size_t axis) const { return points[index][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

using PlaceTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Places>, Places, 3, uint32_t>;

}  // namespace

std::vector<float> distances_to_samples(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                                        const Parallel& parallel) {
  const Places places(samples);
  const PlaceTree tree(3, places, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<float> distances(mesh.vertices.size());
  parallel.for_each(distances.size(), vertices_per_task, [&](size_t v) {
    const Vec3d at = lattice.to_lattice(mesh.vertices[v]);
    uint32_t nearest = 0;
    double squared = 0;
    tree.knnSearch(&at.x, 1, &nearest, &squared);
    distances[v] = static_cast<float>(std::sqrt(squared) * lattice.voxel);
  });
  return distances;
}

}  // namespace soapfilm
