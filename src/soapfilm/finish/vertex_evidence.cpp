#include "soapfilm/finish/vertex_evidence.h"

#include <cmath>
#include <utility>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr size_t vertices_at_once = 1024;

}  // namespace

VertexEvidence vertex_evidence(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, bool distance,
                               bool support, const Context& context) {
  constexpr double disk = 3.141592653589793 * support_radius * support_radius;
  const std::vector<Vec3d> places = lattice_positions(samples);
  const KdTree tree(places);
  VertexEvidence found;
  found.distance.resize(distance ? mesh.vertices.size() : 0);
  found.support.resize(support ? mesh.vertices.size() : 0);
  parallel_chunks(context, mesh.vertices.size(), vertices_at_once, [&](size_t begin, size_t end) {
    std::vector<std::pair<uint32_t, double>> near;
    for (size_t v = begin; v < end; ++v) {
      const Vec3d at = lattice.to_lattice(mesh.vertices[v]);
      if (distance) {
        uint32_t nearest = 0;
        double squared = 0;
        tree->knnSearch(&at.x, 1, &nearest, &squared);
        found.distance[v] = static_cast<float>(std::sqrt(squared) * lattice.voxel);
      }
      if (!support) continue;
      near.clear();
      tree->radiusSearch(&at.x, support_radius * support_radius, near, {});
      double weight = 0;
      for (const auto& [sample, squared] : near) weight += static_cast<double>(samples.weight_of(sample));
      found.support[v] = static_cast<float>(weight / disk);
    }
  });
  return found;
}

}  // namespace soapfilm
