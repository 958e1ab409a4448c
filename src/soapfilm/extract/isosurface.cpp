#include "soapfilm/extract/isosurface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "soapfilm/core/bits.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/indices.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"
#include "soapfilm/error.h"
#include "soapfilm/extract/blocks.h"
#include "soapfilm/extract/cell_window.h"
#include "soapfilm/extract/marching_cubes_table.h"
#include "soapfilm/grid/brick_bits.h"

namespace soapfilm {

namespace {

namespace mc = marching_cubes;

constexpr double least_fraction = 1e-3;  // of an edge, from a vertex to the nearest of its surface points
constexpr double crowded = 0.15;         // of an edge: if cut nearer to an end, its vertices may have to be moved away
constexpr size_t blocks_per_task = 64;

// Ranks share the blocks; each then has the whole mesh.
class Extraction {
 public:
  /// With a `weight` only the cells whose corners all have a positive one are drawn; with a `range`, those in it.
  Extraction(const BrickGrid& grid, const Field<float>& value, const Field<float>* weight,
             const std::optional<VertexRange>& range, const MissingBrickValue& missing_value, float isovalue,
             const Lattice& lattice, const Context& context)
      : grid_(grid),
        value_(value),
        weight_(weight),
        range_(range),
        missing_value_(missing_value),
        isovalue_(isovalue),
        lattice_(lattice),
        context_(context),
        inside_(grid.size()),
        blocks_(mask_of_blocks(grid), context),
        own_(own_part(even_parts(blocks_.size(), context), context)),
        brick_of_(blocks_.size()),
        points_(blocks_.size()),
        split_(weight ? blocks_.size() : 0),
        first_vertex_(blocks_.size() + 1, 0),
        first_triangle_(blocks_.size() + 1, 0) {}

  Mesh run() {
    find_inside();
    parallel_for(context_, blocks_.size(), blocks_per_task,
                 [this](size_t b) { brick_of_[b] = grid_.find(brick_coord(b)); });
    for_blocks(
        with_next_layer(own_, blocks_), [](size_t) { return true; },
        [this](size_t block, const CellWindow& window) { count(block, window); });
    number();
    context_.progress().advance(0.5, "cells counted");
    reserve_many(mesh_.vertices, first_vertex_.back(), pages_of(context_));
    mesh_.vertices.resize(first_vertex_.back());
    reserve_many(mesh_.triangles, first_triangle_.back(), pages_of(context_));
    mesh_.triangles.resize(first_triangle_.back());
    for_blocks(
        own_, [this](size_t block) { return has_vertices(block) || has_triangles(block); },
        [this](size_t block, CellWindow& window) {
          if (has_vertices(block)) {
            fill_values(block, window);
            place_vertices(block, window);
          }
          if (has_triangles(block)) draw_triangles(block, window);
        });
    bring_items(blocks_.size(), {mesh_.vertices.data(), sizeof(Vec3d)}, context_,
                [this](size_t block) { return first_vertex_[block]; });
    bring_items(blocks_.size(), {mesh_.triangles.data(), sizeof(Triangle)}, context_,
                [this](size_t block) { return first_triangle_[block]; });
    return std::move(mesh_);
  }

 private:
  /// Of the bricks around this rank's blocks; and the largest height in all.
  void find_inside() {
    const ItemRange bricks = bricks_around(with_next_layer(own_, blocks_), blocks_, grid_);
    highest_ = join_chunks<double>(
        bricks.size(), blocks_per_task, context_,
        [&](size_t begin, size_t end) {
          double highest = 0;
          for (size_t b = bricks.begin + begin; b < bricks.begin + end; ++b) {
            inside_[b] = BrickBits::above(value_.brick(b), isovalue_);
            highest = std::max(highest, highest_around(b));
          }
          return highest;
        },
        [](double& highest, double part) { highest = std::max(highest, part); });
    if (Ranks* const ranks = ranks_of(context_))
      for (const double highest : of_all(*ranks, highest_)) highest_ = std::max(highest_, highest);
  }

  /// Numbers the vertices and triangles of all blocks, whose numbers ranks have counted.
  void number() {
    const auto number_of_block = [](size_t block) { return block; };
    for (std::vector<uint64_t>* first : {&first_vertex_, &first_triangle_}) {
      bring_items(blocks_.size(), {first->data() + 1, sizeof(uint64_t)}, context_, number_of_block);
      for (size_t b = 0; b < blocks_.size(); ++b) (*first)[b + 1] += (*first)[b];
    }
    require_indices(first_vertex_.back(), most_indices, "vertices of the surface");
    require_indices(first_triangle_.back(), most_triangles, "triangles of the surface");
  }

  bool has_vertices(size_t block) const { return first_vertex_[block + 1] > first_vertex_[block]; }
  bool has_triangles(size_t block) const { return first_triangle_[block + 1] > first_triangle_[block]; }

  /// work(block, window), without the window's values, for the wanted blocks with vertices on both sides.
  template <class Wanted, class Work>
  void for_blocks(ItemRange blocks, Wanted&& wanted, Work&& work) const {
    parallel_chunks(context_, blocks.size(), blocks_per_task, [&](size_t begin, size_t end) {
      CellWindow window;
      for (size_t b = blocks.begin + begin; b < blocks.begin + end; ++b) {
        if (!wanted(b) || !fill_inside(b, window)) continue;
        if (weight_) window.drawn = DrawnCells(grid_, *weight_, brick_coord(b));
        if (range_) window.drawn = DrawnCells(range_->lo, range_->hi, brick_coord(b));
        work(b, window);
      }
    });
  }

  /// Largest absolute height in a brick of the grid and in missing ones next to it.
  double highest_around(size_t brick) const {
    const float* values = value_.brick(brick);
    float least[brick_side], most[brick_side];
    std::copy_n(values, brick_side, least);
    std::copy_n(values, brick_side, most);
    for (int row = 1; row < brick_area; ++row)
      for (int x = 0; x < brick_side; ++x) {
        least[x] = std::min(least[x], values[row * brick_side + x]);
        most[x] = std::max(most[x], values[row * brick_side + x]);
      }
    double highest = 0;
    const auto consider = [&](float value) { highest = std::max(highest, std::abs(double{value} - isovalue_)); };
    std::for_each(std::begin(least), std::end(least), consider);
    std::for_each(std::begin(most), std::end(most), consider);
    for (int slot = 0; slot < 27; ++slot)
      if (grid_.neighbors(brick)[static_cast<size_t>(slot)] < 0)
        consider(missing_value_(grid_.coord(brick) + slot_offset(slot)));
    return highest;
  }

  Vec3i brick_coord(size_t block) const { return brick_of_block(blocks_, block); }

  /// The grid's brick at a block or `step` (-1 to 1 along each axis) from it; < 0 where there is none. Every brick of
  /// the grid is a block too.
  int32_t brick_at(size_t block, Vec3i step) const {
    const int32_t at = blocks_.neighbors(block)[neighbor_slot(step.x, step.y, step.z)];
    return at < 0 ? outside_band : brick_of_[static_cast<size_t>(at)];
  }

  /// Whether the window's vertices lie on both sides.
  bool fill_inside(size_t block, CellWindow& window) const {
    for (auto& layer : window.inside) layer.fill(0);
    for (int d = 0; d < 8; ++d) {
      const Vec3i step{d & 1, d >> 1 & 1, d >> 2};
      const int32_t brick = brick_at(block, step);
      const uint8_t constant = brick < 0 && missing_value_(brick_coord(block) + step) > isovalue_ ? 0xff : 0;
      for (int z = 0; z < (step.z ? 1 : brick_side); ++z)
        for (int y = 0; y < (step.y ? 1 : brick_side); ++y) {
          const unsigned row = brick < 0 ? constant : inside_[static_cast<size_t>(brick)].row(y, z);
          uint16_t& bits = window.inside[step.z * brick_side + z][step.y * brick_side + y];
          bits = static_cast<uint16_t>(bits | (step.x ? (row & 1u) << brick_side : row));
        }
    }
    return window.has_both_sides();
  }

  void fill_values(size_t block, CellWindow& window) const {
    for (int d = 0; d < 8; ++d) {
      const Vec3i step{d & 1, d >> 1 & 1, d >> 2};
      const int32_t brick = brick_at(block, step);
      const float* in = brick < 0 ? nullptr : value_.brick(static_cast<size_t>(brick));
      const float constant = in ? 0.f : missing_value_(brick_coord(block) + step);
      const Vec3i extent{step.x ? 1 : brick_side, step.y ? 1 : brick_side, step.z ? 1 : brick_side};
      for (int z = 0; z < extent.z; ++z) {
        for (int y = 0; y < extent.y; ++y) {
          float* out =
              &window.values[CellWindow::offset(step.x * brick_side, step.y * brick_side + y, step.z * brick_side + z)];
          if (in) {
            std::copy_n(in + brick_offset(0, y, z), extent.x, out);
          } else {
            std::fill_n(out, extent.x, constant);
          }
        }
      }
    }
  }

  void count(size_t block, const CellWindow& window) {
    EdgePoints& points = points_[block];
    const DrawnCells& drawn = window.drawn;
    const auto& inside = window.inside;
    uint32_t total = 0;
    for (int word = 0; word < words_per_block; ++word) {
      const int z = word / 3;
      uint64_t bits = 0;
      for (int y = 0; y < brick_side; ++y) {
        const int upper = word % 3 == 0 ? inside[z][y] >> 1 : word % 3 == 1 ? inside[z][y + 1] : inside[z + 1][y];
        bits |= static_cast<uint64_t>((inside[z][y] ^ upper) & 0xff) << brick_side * y;
      }
      points.bits[word] = bits &= drawn.edges[word];
      points.before[word] = static_cast<uint16_t>(total);
      total += static_cast<uint32_t>(count_bits(bits));
      if (!weight_) continue;
      split_[block][word] = bits & drawn.split[word];
      total += static_cast<uint32_t>(count_bits(split_[block][word]));
    }
    first_vertex_[block + 1] = total;
    uint64_t triangles = 0;
    const auto& table = mc::cases();
    window.for_each_cut_cell([&](int x, int y, int z) { triangles += table[window.case_of(x, y, z)].triangle_count; });
    first_triangle_[block + 1] = triangles;
  }

  void place_vertices(size_t block, const CellWindow& window) {
    const Vec3i origin = brick_coord(block) * brick_side;
    Vec3d* out = &mesh_.vertices[first_vertex_[block]];
    for (int word = 0; word < words_per_block; ++word) {
      const int axis = word % 3;
      for (uint64_t bits = points_[block].bits[word]; bits != 0; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        const Vec3i v{bit % brick_side, bit / brick_side, word / 3};
        Vec3d p(origin + v);
        p[axis] += fraction(block, window, v, axis);
        *out++ = lattice_.to_world(p);
        if (window.drawn.split[word] >> bit & 1) {
          *out = out[-1];
          ++out;
        }
      }
    }
  }

  /// Where the surface cuts the edge from the block's vertex v upwards along an axis, by linear interpolation.
  double fraction(size_t block, const CellWindow& window, Vec3i v, int axis) const {
    Vec3i upper = v;
    ++upper[axis];
    double low = double{window.value(v)} - isovalue_, high = double{window.value(upper)} - isovalue_;
    const double cut = low / (low - high);
    if (cut < crowded || cut > 1 - crowded) {
      low = pushed_away(block, window, v, low);
      high = pushed_away(block, window, upper, high);
    }
    return std::clamp(low / (low - high), least_fraction, 1 - least_fraction);
  }

  /// The height of a vertex over the isovalue; where the surface almost meets the vertex, it is moved along its normal
  /// by at most 1/1000 of an edge, together on all the vertex's edges: points moved one by one would flip the small
  /// triangles between them.
  double pushed_away(size_t block, const CellWindow& window, Vec3i v, double height) const {
    if (std::abs(height) >= least_fraction * (highest_ + std::abs(height))) return height;  // the usual case
    double steepest = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int up : {-1, 1}) {
        Vec3i n = v;
        n[axis] += up;
        const double other = known_value(block, window, n).value_or(isovalue_ + height) - isovalue_;
        if ((other > 0) != (height > 0)) steepest = std::max(steepest, std::abs(other - height));
      }
    const double least = least_fraction * steepest;
    return height > 0 ? std::max(height, least) : std::min(height, -least);
  }

  /// Value of a vertex at most one brick away from the block's; none where unknown.
  std::optional<double> known_value(size_t block, const CellWindow& window, Vec3i v) const {
    if (!weight_ && window.holds(v)) return window.value(v);
    const Vec3i step{v.x >> 3, v.y >> 3, v.z >> 3};
    const int32_t brick = brick_at(block, step);
    if (brick < 0) return weight_ ? std::nullopt : std::optional<double>(missing_value_(brick_coord(block) + step));
    const int k = brick_offset(v.x & 7, v.y & 7, v.z & 7);
    if (weight_ && !(weight_->brick(static_cast<size_t>(brick))[k] > 0)) return std::nullopt;
    return value_.brick(static_cast<size_t>(brick))[k];
  }

  void draw_triangles(size_t block, const CellWindow& window) {
    const auto& table = mc::cases();
    Triangle* out = &mesh_.triangles[first_triangle_[block]];
    window.for_each_cut_cell([&](int x, int y, int z) {
      const auto vertex_on = [&](int edge) { return vertex_index(block, {x, y, z}, edge); };
      const mc::Case& drawn = table[window.case_of(x, y, z)];
      for (int i = 0; i < drawn.triangle_count; ++i) {
        const auto& t = drawn.triangles[i];
        *out++ = {vertex_on(t[0]), vertex_on(t[1]), vertex_on(t[2])};
      }
    });
  }

  /// The mesh vertex on an edge of a block's cell.
  uint32_t vertex_index(size_t block, Vec3i cell, int edge) const {
    const int corner = mc::edge_corner(edge);
    const Vec3i v = cell + Vec3i{corner & 1, corner >> 1 & 1, corner >> 2};
    const int32_t owner = blocks_.neighbors(block)[neighbor_slot(v.x >> 3, v.y >> 3, v.z >> 3)];
    if (owner < 0) refuse_missing(block);
    const int axis = mc::edge_axis(edge);
    const int word = 3 * (v.z & 7) + axis;
    const int bit = (v.x & 7) + brick_side * (v.y & 7);
    const uint64_t lower = (uint64_t{1} << bit) - 1;
    uint64_t index = first_vertex_[owner] + points_[owner].rank(word, lower);
    if (!split_.empty()) {
      const uint64_t split = split_[owner][word];
      index += static_cast<uint64_t>(count_bits(split & lower));
      const bool above = (corner >> takes_second_axis(axis) & 1) == 0;
      if (above && (split >> bit & 1)) ++index;
    }
    return static_cast<uint32_t>(index);
  }

  /// A surface point between two missing bricks: the other side of it would not be drawn.
  [[noreturn]] void refuse_missing(size_t block) const {
    const Vec3i b = brick_coord(block);
    throw ParameterError(fmt::format(
        "missing bricks that touch brick ({}, {}, {}) lie on different sides of the isovalue {}, must agree", b.x, b.y,
        b.z, isovalue_));
  }

  const BrickGrid& grid_;
  const Field<float>& value_;
  const Field<float>* weight_;
  std::optional<VertexRange> range_;
  const MissingBrickValue& missing_value_;
  float isovalue_;
  const Lattice& lattice_;
  const Context& context_;
  double highest_ = 0;             // largest absolute height over the isovalue of all vertices of the surface's cells
  std::vector<BrickBits> inside_;  // by brick of the grid
  BrickGrid blocks_;
  ItemRange own_;                  // blocks that this rank draws
  std::vector<int32_t> brick_of_;  // by block: the grid's brick, < 0 where it has none
  std::vector<EdgePoints> points_;
  std::vector<BrickEdges> split_;  // edges with two surface points; empty for a closed surface
  std::vector<uint64_t> first_vertex_;
  std::vector<uint64_t> first_triangle_;
  Mesh mesh_;
};

void check_bricks(const BrickGrid& grid, const Field<float>& field, const char* name) {
  if (field.bricks() != grid.size()) {
    throw ParameterError(
        fmt::format("the field of {} has {} bricks, must have the grid's {}", name, field.bricks(), grid.size()));
  }
}

}  // namespace

std::optional<VertexRange> drawn_range(const LevelBox& box) {
  if (!box.open) return std::nullopt;
  const Vec3i layer{1, 1, 1};
  return VertexRange{box.free_lo + layer, box.free_hi - layer};
}

Mesh extract_isosurface(const BrickGrid& grid, const Field<float>& value, const MissingBrickValue& missing_value,
                        float isovalue, const Lattice& lattice, const Context& context,
                        const std::optional<VertexRange>& range) {
  check_bricks(grid, value, "values");
  return Extraction(grid, value, nullptr, range, missing_value, isovalue, lattice, context).run();
}

Mesh extract_open_isosurface(const BrickGrid& grid, const Field<float>& value, const Field<float>& weight,
                             float isovalue, const Lattice& lattice, const Context& context) {
  check_bricks(grid, value, "values");
  check_bricks(grid, weight, "weights");
  const MissingBrickValue outside = [isovalue](Vec3i) { return isovalue; };  // never drawn
  return Extraction(grid, value, &weight, {}, outside, isovalue, lattice, context).run();
}

}  // namespace soapfilm
