#include "soapfilm/io/meshes/mesh_blocks.h"

#include <algorithm>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"

namespace soapfilm::io {

namespace {

constexpr size_t block_grain = size_t{1} << 14;

/// Triangles by their centroids along one axis: 32 bits of the place, then the triangle's number.
using PlacedTriangle = uint64_t;

uint32_t triangle_of(PlacedTriangle placed) { return static_cast<uint32_t>(placed); }

/// A third of each coordinate first: the sum of the largest numbers is none.
Vec3d centroid_of(const Mesh& mesh, uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return mesh.vertices[t[0]] / 3.0 + mesh.vertices[t[1]] / 3.0 + mesh.vertices[t[2]] / 3.0;
}

Box3d centroid_box(const Mesh& mesh, std::span<const PlacedTriangle> block, const Context& context) {
  return join_chunks<Box3d>(
      block.size(), block_grain, context,
      [&](size_t begin, size_t end) {
        Box3d box;
        for (size_t i = begin; i < end; ++i) box.extend(centroid_of(mesh, triangle_of(block[i])));
        return box;
      },
      [](Box3d& whole, const Box3d& part) { whole.extend(part); });
}

/// Sorts the block by its longest side, as far as the lower half comes first.
void halve(const Mesh& mesh, std::span<PlacedTriangle> block, const Context& context) {
  const Box3d box = centroid_box(mesh, block, context);
  const Vec3d side = 0.5 * box.hi - 0.5 * box.lo;  // half of it, which is a number
  const int axis = side.y > side.x ? (side.z > side.y ? 2 : 1) : (side.z > side.x ? 2 : 0);
  const double lo = 0.5 * box.lo[axis], scale = side[axis] > 0 ? 4294967295.0 / side[axis] : 0.0;
  const bool by_place = scale < 1e300;  // else all are in one place, nearly
  parallel_for(context, block.size(), block_grain, [&](size_t i) {
    const uint32_t triangle = triangle_of(block[i]);
    const double place = by_place ? (0.5 * centroid_of(mesh, triangle)[axis] - lo) * scale : 0.0;
    block[i] = static_cast<uint64_t>(std::clamp(place, 0.0, 4294967295.0)) << 32 | triangle;
  });
  std::nth_element(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(block.size() / 2), block.end());
}

}  // namespace

MeshBlocks cut_into_blocks(const Mesh& mesh, size_t most, const Context& context) {
  std::vector<PlacedTriangle> placed(mesh.triangles.size());
  for (size_t i = 0; i < placed.size(); ++i) placed[i] = i;
  std::vector<size_t> ends, to_do;  // ends of blocks that are to be cut, the first one last
  if (!placed.empty()) to_do.push_back(placed.size());
  for (size_t begin = 0; !to_do.empty();) {
    context.check();
    const size_t count = to_do.back() - begin;
    if (count > most) {
      halve(mesh, std::span(placed).subspan(begin, count), context);
      to_do.push_back(begin + count / 2);
    } else {
      begin = to_do.back();
      ends.push_back(begin);
      to_do.pop_back();
    }
  }
  std::vector<uint32_t> triangles(placed.size());
  for (size_t i = 0; i < placed.size(); ++i) triangles[i] = triangle_of(placed[i]);
  parallel_for(context, ends.size(), 1, [&](size_t k) {
    const auto at = [&](size_t i) { return triangles.begin() + static_cast<std::ptrdiff_t>(i); };
    std::sort(at(k == 0 ? 0 : ends[k - 1]), at(ends[k]));
  });
  return {std::move(triangles), std::move(ends)};
}

PartMaker::PartMaker(const Mesh& whole, std::span<const Vec3f> normals)
    : whole_(whole), normals_(whole.normals.empty() ? normals : whole.normals), number_(whole.vertices.size(), 0) {}

Mesh PartMaker::part(std::span<const uint32_t> triangles) {
  Mesh part;
  taken_.clear();
  part.triangles.reserve(triangles.size());
  for (const uint32_t t : triangles) {
    Triangle& corners = part.triangles.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = whole_.triangles[t][k];
      uint32_t& number = number_[v];
      if (number == 0) ++vertices_;
      // What an earlier part left may be the number of another vertex.
      if (number == 0 || number > taken_.size() || taken_[number - 1] != v) {
        taken_.push_back(v);
        number = static_cast<uint32_t>(taken_.size());
      }
      corners[k] = number - 1;
    }
  }
  const auto take = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(taken_.size());
    for (const uint32_t v : taken_) to.push_back(from[v]);
  };
  take(whole_.vertices, part.vertices);
  take(normals_, part.normals);
  take(whole_.colors, part.colors);
  for (const Column& column : whole_.attributes) {
    part.attributes.push_back({column.name, {}, column.is_label});
    take(column.values, part.attributes.back().values);
  }
  return part;
}

}  // namespace soapfilm::io
