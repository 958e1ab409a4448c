#include "soapfilm/extract/leaf_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/core/indices.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/radix_sort.h"
#include "soapfilm/error.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/extract/leaf_loops.h"
#include "soapfilm/extract/marching_cubes_table.h"

namespace soapfilm {

namespace {

namespace mc = marching_cubes;
using Kind = LeafAt::Kind;

constexpr double least_fraction = 1e-3;        // of the way between two leaves, to the surface point
constexpr double least_between_levels = 0.02;  // where they differ in size
constexpr double crowded = 0.15;   // where it is nearer to a leaf, that one's points may have to be moved away
constexpr float without_leaf = 3;  // distance where there is none
constexpr size_t blocks_per_task = 16;
constexpr int sides = 6;  // -x, +x, -y, ...
constexpr int all_inside = 0xff;

constexpr Vec3i side_step(int side) {
  const int step = (side & 1) != 0 ? 1 : -1;
  return {side / 2 == 0 ? step : 0, side / 2 == 1 ? step : 0, side / 2 == 2 ? step : 0};
}

/// A corner of a cell, or a neighbor of a leaf: a leaf with its value in voxels of the cell's level, or a place without
/// one.
struct Corner {
  Kind kind = Kind::none;
  uint64_t leaf = 0;  ///< number; of a place without a leaf, its own vertex
  float value = 0;
};

/// What one task draws: triangles as the edges their points lie on. Points in the middle of a loop are numbered from
/// `middle` on.
struct Drawn {
  std::vector<std::array<uint64_t, 3>> triangles;
  std::vector<Vec3d> middles;
};
constexpr uint64_t middle = uint64_t{1} << 62;

class LeafExtraction {
 public:
  LeafExtraction(LeafLevels levels, std::span<const Field<float>* const> values, const SideWithoutLeaves& inside,
                 const Lattice& lattice, const Context& context)
      : levels_(levels), values_(values), inside_(inside), lattice_(lattice), context_(context) {
    for (const BrickGrid* grid : levels) {
      ranges_.push_back(lattice.open ? drawn_range(lattice.box(static_cast<int>(ranges_.size()))) : std::nullopt);
      first_brick_.push_back(first_brick_.back() + grid->size());
    }
  }

  Mesh run() {
    std::vector<Drawn> drawn;
    for (size_t l = 0; l < levels_.size(); ++l) draw_level(static_cast<int>(l), drawn);
    return numbered(drawn);
  }

 private:
  const BrickGrid& grid(int level) const { return *levels_[static_cast<size_t>(level)]; }

  uint64_t leaf_number(int level, LeafAt at) const {
    return (first_brick_[static_cast<size_t>(level)] + static_cast<uint64_t>(at.brick)) * brick_volume +
           static_cast<uint64_t>(at.offset);
  }
  float value_of(int level, LeafAt at) const {
    return values_[static_cast<size_t>(level)]->brick(static_cast<size_t>(at.brick))[at.offset];
  }

  /// In voxels of `level`.
  Corner corner_at(int level, Vec3i vertex) const {
    const LeafAt at = leaf_at(levels_, level, vertex);
    switch (at.kind) {
      case Kind::leaf:
        return {at.kind, leaf_number(level, at), value_of(level, at)};
      case Kind::coarser:
        return {at.kind, leaf_number(level + 1, at), 2 * value_of(level + 1, at)};
      case Kind::finer:
        return {at.kind, 0, 0};
      case Kind::none:
        break;
    }
    return {at.kind, 0, inside_(level, vertex) ? without_leaf : -without_leaf};
  }

  /// A leaf's level and vertex.
  std::pair<int, Vec3i> place_of(uint64_t leaf) const {
    const uint64_t brick = leaf / brick_volume;
    const auto level =
        static_cast<int>(std::upper_bound(first_brick_.begin(), first_brick_.end(), brick) - first_brick_.begin()) - 1;
    const auto own = static_cast<size_t>(brick - first_brick_[static_cast<size_t>(level)]);
    return {level, grid(level).first_vertex(own) + vertex_in_brick(static_cast<int>(leaf % brick_volume))};
  }

  /// Cells lie between vertices v and v + 1; a block has those whose v is in one brick. Bricks with leaves, and those
  /// just below them.
  void draw_level(int level, std::vector<Drawn>& drawn) {
    BrickMask mask(grid(level).bricks() + Vec3i{1, 1, 1});
    for (size_t b = 0; b < grid(level).size(); ++b)
      for (int k = 0; k < 8; ++k) mask.set(grid(level).coord(b) + octant_of(k));
    const BrickGrid blocks(mask, context_);
    const size_t before = drawn.size();
    drawn.resize(before + (blocks.size() + blocks_per_task - 1) / blocks_per_task);
    parallel_chunks(context_, blocks.size(), blocks_per_task, [&](size_t begin, size_t end) {
      for (size_t b = begin; b < end; ++b)
        draw_block(level, blocks.coord(b) - Vec3i{1, 1, 1}, drawn[before + begin / blocks_per_task]);
    });
  }

  void draw_block(int level, Vec3i block, Drawn& drawn) const {
    constexpr int side = brick_side + 1;
    std::array<Corner, side * side * side> corners;
    const Vec3i first = block * brick_side;
    bool both[2] = {};
    for (int i = 0; i < side * side * side; ++i) {
      const Vec3i v{i % side, i / side % side, i / (side * side)};
      Corner& c = corners[static_cast<size_t>(i)] = corner_at(level, first + v);
      if (c.kind != Kind::finer) both[c.value > 0] = true;
    }
    if (!both[0] || !both[1]) return;
    for (int z = 0; z < brick_side; ++z)
      for (int y = 0; y < brick_side; ++y)
        for (int x = 0; x < brick_side; ++x) {
          std::array<Corner, 8> cell;
          for (int k = 0; k < 8; ++k) {
            const Vec3i v = Vec3i{x, y, z} + octant_of(k);
            cell[static_cast<size_t>(k)] = corners[static_cast<size_t>(v.x + side * (v.y + side * v.z))];
          }
          draw_cell(level, first + Vec3i{x, y, z}, cell, drawn);
        }
  }

  /// Of a closed surface all cells are; of an open box those in front of its border (drawn_range()).
  bool is_drawn(int level, Vec3i v) const {
    const std::optional<VertexRange>& range = ranges_[static_cast<size_t>(level)];
    return !range || (v.x >= range->lo.x && v.y >= range->lo.y && v.z >= range->lo.z && v.x < range->hi.x &&
                      v.y < range->hi.y && v.z < range->hi.z);
  }

  void draw_cell(int level, Vec3i v, const std::array<Corner, 8>& cell, Drawn& drawn) const {
    int mask = 0, leaves = 0;
    for (size_t k = 0; k < 8; ++k) {
      if (cell[k].kind == Kind::finer) return;  // finer cells are there
      mask |= static_cast<int>(cell[k].value > 0) << k;
      leaves += cell[k].kind == Kind::leaf;
    }
    if (leaves == 0 || mask == 0 || mask == all_inside || !is_drawn(level, v)) return;
    std::array<uint64_t, mc::edge_count> edges;
    for (int e = 0; e < mc::edge_count; ++e) edges[static_cast<size_t>(e)] = edge_of(level, v, cell, mask, e);
    const mc::Case& table = mc::cases()[static_cast<size_t>(mask)];
    if (leaves == 8 || mc::is_tunnel(mask)) {  // a tube between two loops is in the table alone
      for (int t = 0; t < table.triangle_count; ++t) {
        std::array<uint64_t, 3> triangle{};
        for (size_t i = 0; i < 3; ++i) triangle[i] = edges[table.triangles[static_cast<size_t>(t)][i]];
        if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
          drawn.triangles.push_back(triangle);
      }
      return;
    }
    FaceEdges faces;
    for (int f = 0; f < 6; ++f) {
      const auto corners = mc::face_corners(f);
      for (size_t i = 0; i < 4; ++i)
        faces[static_cast<size_t>(f)][i] =
            edges[static_cast<size_t>(mc::edge_between(corners[i], corners[(i + 1) % 4]))];
    }
    for (const std::vector<int>& loop : mc::trace_loops(mask)) draw_loop(loop, edges, faces, drawn);
  }

  void draw_loop(const std::vector<int>& loop, const std::array<uint64_t, mc::edge_count>& edges,
                 const FaceEdges& faces, Drawn& drawn) const {
    std::vector<LoopPoint> points;
    for (const int e : loop) points.push_back({edges[static_cast<size_t>(e)], point_on(edges[static_cast<size_t>(e)])});
    for (const std::vector<LoopPoint>& simple : simple_loops(std::move(points))) {
      std::vector<std::array<int, 3>> triangles;
      if (triangulate_loop(simple, faces, triangles)) {
        for (const auto& t : triangles)
          drawn.triangles.push_back({simple[static_cast<size_t>(t[0])].edge, simple[static_cast<size_t>(t[1])].edge,
                                     simple[static_cast<size_t>(t[2])].edge});
        continue;
      }
      Vec3d sum;
      for (const LoopPoint& p : simple) sum += p.place;
      const uint64_t own = middle + drawn.middles.size();
      drawn.middles.push_back(sum / static_cast<double>(simple.size()));
      for (size_t i = 0; i < simple.size(); ++i)
        drawn.triangles.push_back({simple[i].edge, simple[(i + 1) % simple.size()].edge, own});
    }
  }

  /// The number of the edge between two leaves that are corners of a cell: that of one of them, the smaller, or of
  /// equal ones the lower, and the side on which the other lies. Only that of edges that the surface cuts counts.
  uint64_t edge_of(int level, Vec3i v, const std::array<Corner, 8>& cell, int mask, int edge) const {
    const int low = mc::edge_corner(edge), axis = mc::edge_axis(edge), high = low | 1 << axis;
    if ((mask >> low & 1) == (mask >> high & 1)) return no_edge;
    const Corner &a = cell[static_cast<size_t>(low)], &b = cell[static_cast<size_t>(high)];
    const auto rank = [](const Corner& c) { return c.kind == Kind::leaf ? 0 : c.kind == Kind::coarser ? 1 : 2; };
    if (a.kind == Kind::none && b.kind == Kind::none) refuse(level, v);
    return rank(a) <= rank(b) ? a.leaf * sides + static_cast<uint64_t>(2 * axis + 1)
                              : b.leaf * sides + static_cast<uint64_t>(2 * axis);
  }

  [[noreturn]] static void refuse(int level, Vec3i v) {
    throw ParameterError(
        fmt::format("the surface passes between places without leaves at vertex ({}, {}, {}) of level {}, must not",
                    v.x, v.y, v.z, level));
  }

  /// A leaf's value, away from 0 by at least 1/1000 of the steepest step to a neighbor on the other side: where the
  /// surface almost meets it all points around it are moved together, as points moved one by one would turn the small
  /// triangles between them.
  double height(int level, Vec3i v, double value) const {
    double steepest = 0;
    for (int side = 0; side < sides; ++side) {
      const Corner next = corner_at(level, v + side_step(side));
      if (next.kind == Kind::finer || (next.value > 0) == (value > 0)) continue;
      steepest = std::max(steepest, std::abs(next.value - value));
    }
    const double least = least_fraction * steepest;
    return value > 0 ? std::max(value, least) : std::min(value, -least);
  }

  /// In lattice coordinates of the finest level.
  Vec3d point_on(uint64_t edge) const {
    const auto [level, v] = place_of(edge / sides);
    const Vec3i other = v + side_step(static_cast<int>(edge % sides));
    const Corner a = corner_at(level, v), b = corner_at(level, other);
    const bool between_levels = b.kind == Kind::coarser;
    const Vec3i coarse{other.x >> 1, other.y >> 1, other.z >> 1};
    double ha = a.value, hb = b.value;
    if (const double cut = ha / (ha - hb); cut < crowded || cut > 1 - crowded) {
      ha = height(level, v, ha);
      if (b.kind == Kind::leaf) hb = height(level, other, hb);
      if (between_levels) hb = 2 * height(level + 1, coarse, hb / 2);
    }
    const double least = between_levels ? least_between_levels : least_fraction;
    const double t = std::clamp(ha / (ha - hb), least, 1 - least);
    const Vec3d from = leaf_center(level, v),
                to = between_levels ? leaf_center(level + 1, coarse) : leaf_center(level, other);
    return from + (to - from) * t;
  }

  /// Points numbered in the order of their edges, those in the middle of loops after them.
  Mesh numbered(const std::vector<Drawn>& drawn) const {
    std::vector<uint64_t> edges;
    std::vector<size_t> first_triangle = {0}, first_middle = {0};
    for (const Drawn& part : drawn) {
      first_triangle.push_back(first_triangle.back() + part.triangles.size());
      first_middle.push_back(first_middle.back() + part.middles.size());
      for (const auto& triangle : part.triangles)
        for (const uint64_t edge : triangle)
          if (edge < middle) edges.push_back(edge);
    }
    const uint64_t last = first_brick_.back() * brick_volume * sides;
    radix_sort(edges, static_cast<int>(std::bit_width(last)), context_);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    require_indices(edges.size() + first_middle.back(), most_indices, "vertices of the surface");
    require_indices(first_triangle.back(), most_triangles, "triangles of the surface");
    Mesh mesh;
    mesh.vertices.resize(edges.size() + first_middle.back());
    mesh.triangles.resize(first_triangle.back());
    parallel_for(context_, edges.size(), 1 << 10,
                 [&](size_t i) { mesh.vertices[i] = lattice_.to_world(point_on(edges[i])); });
    parallel_for(context_, drawn.size(), 1, [&](size_t k) {
      for (size_t i = 0; i < drawn[k].middles.size(); ++i)
        mesh.vertices[edges.size() + first_middle[k] + i] = lattice_.to_world(drawn[k].middles[i]);
      for (size_t t = 0; t < drawn[k].triangles.size(); ++t) {
        std::array<uint32_t, 3> indices;
        for (size_t i = 0; i < 3; ++i) {
          const uint64_t edge = drawn[k].triangles[t][i];
          const auto at = edge < middle
                              ? static_cast<size_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin())
                              : edges.size() + first_middle[k] + static_cast<size_t>(edge - middle);
          indices[i] = static_cast<uint32_t>(at);
        }
        mesh.triangles[first_triangle[k] + t] = {indices[0], indices[1], indices[2]};
      }
    });
    return mesh;
  }

  LeafLevels levels_;
  std::span<const Field<float>* const> values_;
  const SideWithoutLeaves& inside_;
  const Lattice& lattice_;
  const Context& context_;
  std::vector<std::optional<VertexRange>> ranges_;
  std::vector<uint64_t> first_brick_ = {0};  ///< of each level, among all
};

}  // namespace

Mesh extract_leaf_surface(LeafLevels levels, std::span<const Field<float>* const> values,
                          const SideWithoutLeaves& inside, const Lattice& lattice, const Context& context) {
  if (values.size() != levels.size())
    throw ParameterError(
        fmt::format("{} fields of values, must be one for each of {} levels", values.size(), levels.size()));
  check_leaves(levels);
  return LeafExtraction(levels, values, inside, lattice, context).run();
}

}  // namespace soapfilm
