#include "tools/tiles/tile_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/simplify/engine.h"
#include "tools/tiles/tile_part.h"

namespace soapfilm {

namespace {

constexpr int deepest = 20;
constexpr size_t least_triangles = 100;

/// A cell of the octree and its triangles, sorted by cells: [begin, end).
struct Node {
  int depth;
  Vec3i cell;
  size_t begin, end;
  std::vector<size_t> children;
};

/// Nodes, children before their parents; the order of triangles that they refer to.
struct Octree {
  std::vector<Node> nodes;
  std::vector<uint32_t> triangles;

  Octree(const Mesh& mesh, size_t most) : triangles(mesh.triangles.size()) {
    const Box3d box = mesh.box();
    const double side = box.longest() * (1 + 1e-9);
    std::vector<Vec3i> deep(triangles.size());
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      triangles[t] = t;
      const Triangle& corners = mesh.triangles[t];
      const Vec3d middle =
          (mesh.vertices[corners[0]] + mesh.vertices[corners[1]] + mesh.vertices[corners[2]]) / 3.0 - box.lo;
      for (int axis = 0; axis < 3; ++axis)
        deep[t][axis] =
            std::clamp(static_cast<int>(std::floor(std::ldexp(middle[axis] / side, deepest))), 0, (1 << deepest) - 1);
    }
    split({0, {0, 0, 0}, 0, triangles.size(), {}}, deep, most);
  }

 private:
  /// Triangles keep their order within a cell. Returns the node's number.
  size_t split(Node node, const std::vector<Vec3i>& deep, size_t most) {
    if (node.end - node.begin > most && node.depth < deepest) {
      const int bit = deepest - node.depth - 1;
      const auto octant = [&](uint32_t t) {
        return (deep[t].x >> bit & 1) + 2 * (deep[t].y >> bit & 1) + 4 * (deep[t].z >> bit & 1);
      };
      const auto at = [&](size_t i) { return triangles.begin() + static_cast<std::ptrdiff_t>(i); };
      std::stable_sort(at(node.begin), at(node.end), [&](uint32_t a, uint32_t b) { return octant(a) < octant(b); });
      for (size_t begin = node.begin, end = begin; begin < node.end; begin = end) {
        const int k = octant(triangles[begin]);
        while (end < node.end && octant(triangles[end]) == k) ++end;
        const Vec3i cell = 2 * node.cell + Vec3i{k & 1, k >> 1 & 1, k >> 2};
        node.children.push_back(split({node.depth + 1, cell, begin, end, {}}, deep, most));
      }
    }
    nodes.push_back(std::move(node));
    return nodes.size() - 1;
  }
};

/// The first and the last place, in the order of the octree, of a triangle at each vertex.
struct Reach {
  std::vector<size_t> first, last;

  Reach(const Mesh& mesh, const std::vector<uint32_t>& order)
      : first(mesh.vertices.size(), std::numeric_limits<size_t>::max()), last(mesh.vertices.size(), 0) {
    for (size_t i = 0; i < order.size(); ++i)
      for (const uint32_t v : mesh.triangles[order[i]]) {
        first[v] = std::min(first[v], i);
        last[v] = std::max(last[v], i);
      }
  }
  bool leaves(uint32_t v, const Node& node) const { return first[v] < node.begin || last[v] >= node.end; }
};

/// Power of two such that differences of coordinates of the box are floats, also of half steps.
double step_for(const Box3d& box) {
  int exponent;
  std::frexp(box.longest(), &exponent);
  constexpr int digits = 22;
  return std::ldexp(1, exponent - digits);
}

void round_to(double step, Mesh& mesh) {
  for (Vec3d& v : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) v[axis] = std::round(v[axis] / step) * step;
}

class TileMaker {
 public:
  TileMaker(const Mesh& mesh, const TileParams& params)
      : whole_(mesh), octree_(mesh, params.triangles), reach_(mesh, octree_.triangles), most_(params.triangles) {}

  TileTree make(double step, const Context& context) {
    TileTree tree;
    tree.step = step;
    const std::vector<Node>& nodes = octree_.nodes;
    parts_.resize(nodes.size());
    errors_.resize(nodes.size());
    tree.tiles.resize(nodes.size());
    size_t done = 0;
    int deepest_node = 0;
    for (const Node& node : nodes) deepest_node = std::max(deepest_node, node.depth);
    for (int depth = deepest_node; depth >= 0; --depth) {
      std::vector<size_t> of_depth;
      for (size_t n = 0; n < nodes.size(); ++n)
        if (nodes[n].depth == depth) of_depth.push_back(n);
      parallel_for(context, of_depth.size(), 1, [&](size_t i) {
        const size_t n = of_depth[i];
        make_part(n, silenced(context));
        Tile& tile = tree.tiles[n];
        tile = {depth, nodes[n].cell, parts_[n].mesh, errors_[n], nodes[n].children};
        round_to(step, tile.mesh);
        tile.error +=
            2 * step;  // more than half of the diagonal of a cell of steps, twice: of the mesh and of this one
      });
      done += of_depth.size();
      context.progress().advance(static_cast<double>(done) / static_cast<double>(nodes.size()),
                                 fmt::format("{} of {} tiles", done, nodes.size()));
    }
    return tree;
  }

 private:
  void make_part(size_t n, const Context& context) {
    const Node& node = octree_.nodes[n];
    if (node.children.empty()) {
      const std::span<const uint32_t> triangles(octree_.triangles);
      parts_[n] = part_of_mesh(whole_, triangles.subspan(node.begin, node.end - node.begin));
      return;
    }
    std::vector<TilePart> children;
    for (const size_t child : node.children) {
      children.push_back(std::move(parts_[child]));
      errors_[n] = std::max(errors_[n], errors_[child]);
    }
    TilePart part = joined(children, whole_.vertices.size());
    children.clear();
    split_fans(part);
    std::vector<uint8_t> fixed(part.whole.size());
    for (size_t v = 0; v < fixed.size(); ++v)
      fixed[v] = part.whole[v] != TilePart::none && reach_.leaves(part.whole[v], node);
    // With fewer triangles for its border a tile would lose its shape.
    constexpr size_t of_fixed = 3;
    const auto fixed_count = static_cast<size_t>(std::count(fixed.begin(), fixed.end(), 1));
    Simplified simple = simplify_to(part.mesh, std::max(most_, of_fixed * fixed_count), fixed, context);
    errors_[n] += simple.report.proved;
    parts_[n] = still_known(part, fixed, std::move(simple.mesh));
  }

  /// Vertices keep their order, and fixed ones their places: so they are found again. The others have moved, or might
  /// have.
  static TilePart still_known(const TilePart& before, const std::vector<uint8_t>& fixed, Mesh mesh) {
    TilePart after{std::move(mesh), {}};
    after.whole.assign(after.mesh.vertices.size(), TilePart::none);
    size_t next = 0;
    const auto skip = [&] {
      while (next < fixed.size() && !fixed[next]) ++next;
    };
    skip();
    for (size_t v = 0; v < after.whole.size() && next < fixed.size(); ++v) {
      if (!(after.mesh.vertices[v] == before.mesh.vertices[next])) continue;
      after.whole[v] = before.whole[next++];
      skip();
    }
    if (next != fixed.size()) throw ParameterError("tiles: a border vertex was lost");
    return after;
  }

  const Mesh& whole_;
  Octree octree_;
  Reach reach_;
  size_t most_;
  std::vector<TilePart> parts_;
  std::vector<double> errors_;
};

}  // namespace

TileTree make_tiles(const Mesh& mesh, const TileParams& params, const Context& context) {
  if (params.triangles < least_triangles)
    throw ParameterError(fmt::format("triangles of a tile = {}, must be >= {}", params.triangles, least_triangles));
  if (mesh.triangles.empty()) throw ParameterError("mesh: it has no triangles");
  Mesh rounded = mesh;
  const double step = step_for(mesh.box());
  round_to(step, rounded);
  if (rounded.normals.empty()) {  // of the whole surface, so that no seam shows between tiles
    io::FaceNormals faces(rounded.vertices);
    for (const Triangle& triangle : rounded.triangles) faces.add(triangle);
    rounded.normals = faces.finish();
  }
  return TileMaker(rounded, params).make(step, context);
}

}  // namespace soapfilm
