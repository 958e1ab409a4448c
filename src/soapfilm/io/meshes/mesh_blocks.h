// A mesh cut into blocks of space, along its edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm::io {

/// Which triangles each block has.
class MeshBlocks {
 public:
  MeshBlocks(std::vector<uint32_t> triangles, std::vector<size_t> ends)
      : triangles_(std::move(triangles)), ends_(std::move(ends)) {}

  size_t size() const { return ends_.size(); }
  /// Numbers of triangles, in order.
  std::span<const uint32_t> operator[](size_t block) const {
    const size_t begin = block == 0 ? 0 : ends_[block - 1];
    return std::span(triangles_).subspan(begin, ends_[block] - begin);
  }

 private:
  std::vector<uint32_t> triangles_;  // block after block
  std::vector<size_t> ends_;
};

/// Halves the box of the triangles' centroids across its longest side (of equal ones the first axis) at the median, so
/// that the lower half has one triangle less if their number is odd; equal centroids by the triangles' numbers. The
/// halves likewise, until none has more than `most` triangles, which is > 0. Blocks are in the order of their lower
/// halves first; of a mesh without triangles there is none. Takes 12 bytes a triangle. The same for any number of
/// threads.
MeshBlocks cut_into_blocks(const Mesh& mesh, size_t most, const Context& context);

/// Takes parts out of one mesh. Vertices of a part are in the order in which its triangles name them, with all that
/// they have.
class PartMaker {
 public:
  /// Of a mesh without normals the parts have these, unless there are none.
  PartMaker(const Mesh& whole, std::span<const Vec3f> normals);

  Mesh part(std::span<const uint32_t> triangles);
  /// Of all parts so far, each once.
  size_t vertices() const { return vertices_; }

 private:
  const Mesh& whole_;
  std::span<const Vec3f> normals_;
  std::vector<uint32_t> number_;  // of each vertex of the whole mesh: its number in the last part that has it, plus one
  std::vector<uint32_t> taken_;   // vertices of the part in progress
  size_t vertices_ = 0;
};

}  // namespace soapfilm::io
