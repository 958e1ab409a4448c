#include "soapfilm/finish/trim_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/finish/nearest_sample.h"

namespace soapfilm {

namespace {

constexpr double search_share = 1.5;  // of the distance: how far samples are searched
constexpr int smoothing_passes = 3;   // otherwise a ragged cut follows single samples
constexpr size_t vertices_per_task = 1024;

std::vector<Vec3d> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3d> normals(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]];
    const Vec3d n = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    for (const uint32_t v : t) normals[v] += n;
  }
  for (Vec3d& n : normals) n = normalized(n);
  return normals;
}

/// Mean cosine of a normal and the directions of the nearest samples, [-1, 1]; 1 where there are none within `reach`
/// or, where samples are sparse, within three times the distance of the nearest one.
class Facing {
 public:
  Facing(const GridSamples& samples, double reach)
      : samples_(samples), reach_(reach), places_(lattice_positions(samples)), tree_(places_) {}

  double at(Vec3d place, Vec3d normal, uint32_t& nearest) const {
    constexpr size_t most = 6;
    constexpr double spacings = 3;
    std::array<uint32_t, most> index{};
    std::array<double, most> squared{};
    const size_t found = tree_->knnSearch(&place.x, most, index.data(), squared.data());
    if (found == 0) return 1;
    if (squared[0] <= reach_ * reach_) nearest = index[0];
    const double limit = std::max(reach_ * reach_, spacings * spacings * squared[0]);
    double sum = 0, weights = 0;
    for (size_t k = 0; k < found && squared[k] <= limit; ++k) {
      const Vec3f direction = samples_.direction[index[k]];
      const double weight = static_cast<double>(samples_.weight_of(index[k]));
      sum += weight * dot(normal, normalized(Vec3d(direction)));
      weights += weight;
    }
    return weights > 0 ? sum / weights : 1;
  }

 private:
  const GridSamples& samples_;
  double reach_;
  std::vector<Vec3d> places_;
  KdTree tree_;
};

/// Jacobi passes, in the order of the triangles. Vertices at or below 1 stay there.
void smooth(const Mesh& mesh, std::vector<double>& level) {
  const std::vector<double> measured = level;
  std::vector<double> sum(level.size());
  std::vector<uint32_t> neighbors(level.size());
  for (int pass = 0; pass < smoothing_passes; ++pass) {
    std::fill(sum.begin(), sum.end(), 0);
    std::fill(neighbors.begin(), neighbors.end(), 0);
    for (const Triangle& t : mesh.triangles)
      for (size_t k = 0; k < 3; ++k) {
        sum[t[k]] += level[t[(k + 1) % 3]] + level[t[(k + 2) % 3]];
        neighbors[t[k]] += 2;
      }
    for (size_t v = 0; v < level.size(); ++v)
      if (neighbors[v] > 0) level[v] = 0.5 * (level[v] + sum[v] / neighbors[v]);
  }
  for (size_t v = 0; v < level.size(); ++v)
    if (measured[v] <= 1) level[v] = std::min(level[v], measured[v]);
}

}  // namespace

TrimLevels find_trim_levels(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, double distance,
                            bool facing, const Context& context) {
  const double voxels = distance / lattice.voxel;
  TrimLevels found;
  found.level.resize(mesh.vertices.size());
  parallel_for(context, mesh.vertices.size(), vertices_per_task, [&](size_t v) {
    found.level[v] =
        distance_to_samples(samples, lattice.to_lattice(mesh.vertices[v]), voxels / 2, search_share * voxels) / voxels;
  });
  if (facing) {
    constexpr double slope = 0.5;  // of the level by the mean cosine
    const std::vector<Vec3d> normals = vertex_normals(mesh);
    const Facing samples_around(samples, voxels);
    found.unfaced.resize(mesh.vertices.size());
    found.nearest.assign(mesh.vertices.size(), TrimLevels::none);
    parallel_for(context, mesh.vertices.size(), vertices_per_task, [&](size_t v) {
      const Vec3d normal = static_cast<Vec3d>(lattice.from_world_axes(Vec3f(normals[v])));
      const double cosine = samples_around.at(lattice.to_lattice(mesh.vertices[v]), normal, found.nearest[v]);
      found.unfaced[v] = cosine < 0;
      found.level[v] = std::max(found.level[v], 1 - slope * cosine);
    });
  }
  smooth(mesh, found.level);
  return found;
}

}  // namespace soapfilm
