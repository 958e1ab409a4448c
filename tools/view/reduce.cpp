#include "tools/view/reduce.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "soapfilm/core/random.h"

namespace soapfilm::view_detail {

namespace {

/// Simplified in place; returns the error. The careful way keeps the topology; where that leaves far too many triangles
/// (a soup of thousands of parts), the other one gives parts up.
double simplify(std::vector<uint32_t>& indices, const std::vector<Vec3f>& positions, size_t triangles) {
  const size_t target = 3 * triangles;
  const float* const first = &positions[0].x;
  constexpr size_t stride = sizeof(Vec3f);
  std::vector<uint32_t> fewer(indices.size());
  float error = 0;
  fewer.resize(meshopt_simplify(fewer.data(), indices.data(), indices.size(), first, positions.size(), stride, target,
                                1.0F, 0, &error));
  if (fewer.size() > 2 * target) {
    fewer.resize(indices.size());
    float rough = 0;
    fewer.resize(meshopt_simplifySloppy(fewer.data(), indices.data(), indices.size(), first, positions.size(), stride,
                                        target, 1.0F, &rough));
    error = rough;
  }
  if (fewer.empty()) return 0;
  indices = std::move(fewer);
  return error * meshopt_simplifyScale(first, positions.size(), stride);
}

}  // namespace

DrawnMesh drawn_mesh(const Mesh& mesh, const std::vector<Vec3f>& positions, size_t triangles) {
  DrawnMesh drawn;
  drawn.indices.reserve(3 * mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles)
    drawn.indices.insert(drawn.indices.end(), triangle.begin(), triangle.end());
  if (triangles > 0 && mesh.triangles.size() > triangles) drawn.error = simplify(drawn.indices, positions, triangles);

  const size_t count = drawn.indices.size();
  meshopt_optimizeVertexCache(drawn.indices.data(), drawn.indices.data(), count, positions.size());
  std::vector<uint32_t> remap(positions.size());
  const size_t used = meshopt_optimizeVertexFetchRemap(remap.data(), drawn.indices.data(), count, positions.size());
  meshopt_remapIndexBuffer(drawn.indices.data(), drawn.indices.data(), count, remap.data());
  drawn.vertices.resize(used);
  for (size_t i = 0; i < remap.size(); ++i)
    if (remap[i] != UINT32_MAX) drawn.vertices[remap[i]] = static_cast<uint32_t>(i);
  return drawn;
}

std::vector<uint32_t> thinned(size_t count, size_t most) {
  std::vector<uint32_t> kept(count);
  std::iota(kept.begin(), kept.end(), 0U);
  if (most == 0 || count <= most) return kept;
  std::vector<std::pair<uint64_t, uint32_t>> by_hash(count);
  for (size_t i = 0; i < count; ++i) by_hash[i] = {Random(i).next(), static_cast<uint32_t>(i)};
  std::nth_element(by_hash.begin(), by_hash.begin() + static_cast<std::ptrdiff_t>(most), by_hash.end());
  kept.resize(most);
  for (size_t i = 0; i < most; ++i) kept[i] = by_hash[i].second;
  std::sort(kept.begin(), kept.end());
  return kept;
}

std::vector<uint32_t> sorted_in_space(const std::vector<uint32_t>& samples, const std::vector<Vec3f>& positions) {
  if (samples.empty()) return {};
  std::vector<Vec3f> chosen(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) chosen[i] = positions[samples[i]];
  std::vector<uint32_t> place(samples.size());
  meshopt_spatialSortRemap(place.data(), &chosen[0].x, chosen.size(), sizeof(Vec3f));
  std::vector<uint32_t> sorted(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) sorted[place[i]] = samples[i];
  return sorted;
}

}  // namespace soapfilm::view_detail
