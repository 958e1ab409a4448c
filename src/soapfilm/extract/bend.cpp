#include "soapfilm/extract/bend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/core/error.h"
#include "soapfilm/extract/flip.h"
#include "soapfilm/extract/leftover.h"

namespace soapfilm {

namespace {

constexpr double reach = 0.25;        // voxels, the most that a vertex moves onto the smooth surface
constexpr double suspicion = 0.33;    // of the tolerance: a sag by the ends' normals that is looked at closely
constexpr double least_gain = 0.004;  // voxels
constexpr double least_cosine = 0.4;  // between a triangle's normals before and after its corners move
constexpr int most_halvings = 3;      // of a move that turns one further; then it is taken back
constexpr size_t triangles_per_task = 1 << 14;
constexpr size_t points_per_task = 1 << 10;
constexpr uint32_t none = ~uint32_t{0};

struct Edge {
  uint32_t a, b;  // vertices, a < b
};

/// Of the smooth surface, at each vertex; zero where it is not known.
std::vector<Vec3f> vertex_normals(const Mesh& mesh, const SmoothField& field, const Lattice& lattice,
                                  const Parallel& parallel) {
  std::vector<Vec3f> normals(mesh.vertices.size());
  parallel.for_each(normals.size(), points_per_task, [&](size_t v) {
    if (const auto jet = field.at(lattice.to_lattice(mesh.vertices[v]))) normals[v] = Vec3f(normalized(jet->gradient));
  });
  return normals;
}

class Bending {
 public:
  Bending(Mesh& mesh, const SmoothField& field, const Lattice& lattice, double tolerance, const Parallel& parallel)
      : mesh_(mesh), field_(field), lattice_(lattice), tolerance_(tolerance), parallel_(parallel) {}

  size_t run(const Leftover& leftover) {
    const std::vector<Vec3f> normals = vertex_normals(mesh_, field_, lattice_, parallel_);
    flip_edges(mesh_, normals, lattice_.voxel, least_gain * lattice_.voxel, parallel_);
    find_suspects(normals);
    place_ends();
    place_middles();
    keep_split();
    const size_t old = mesh_.vertices.size();
    start_ = mesh_.vertices;
    for (const Edge& e : edges_) start_.push_back(0.5 * (start_[e.a] + start_[e.b]));
    mesh_.vertices.resize(start_.size());
    parallel_.for_each(start_.size(), points_per_task, [&](size_t v) {
      const Vec3d p = v >= old           ? middles_[v - old]
                      : slot_[v] == none ? lattice_.to_lattice(start_[v])
                                         : ends_[slot_[v]];
      mesh_.vertices[v] = settled(p, leftover);
    });
    first_new_ = old;
    cut_triangles();
    unfold();
    return edges_.size();
  }

 private:
  /// Every edge of a closed mesh runs upwards in one of its triangles.
  void find_suspects(const std::vector<Vec3f>& normals) {
    const double limit = suspicion * tolerance_ * lattice_.voxel;
    std::vector<std::vector<Edge>> found((mesh_.triangles.size() + triangles_per_task - 1) / triangles_per_task);
    parallel_.for_chunks(mesh_.triangles.size(), triangles_per_task, [&](size_t begin, size_t end) {
      for (size_t t = begin; t < end; ++t)
        for (size_t k = 0; k < 3; ++k) {
          const Edge e{mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]};
          if (e.a > e.b) continue;
          if (sag(mesh_.vertices[e.a], mesh_.vertices[e.b], normals[e.a], normals[e.b]) > limit)
            found[begin / triangles_per_task].push_back(e);
        }
    });
    for (const auto& part : found) edges_.insert(edges_.end(), part.begin(), part.end());
  }

  /// The vertices of the edges, in their order, and where they go.
  void list_moved() {
    moved_.clear();
    slot_.assign(mesh_.vertices.size(), none);
    for (const Edge& e : edges_) slot_[e.a] = slot_[e.b] = 0;
    for (uint32_t v = 0; v < slot_.size(); ++v)
      if (slot_[v] != none) {
        slot_[v] = static_cast<uint32_t>(moved_.size());
        moved_.push_back(v);
      }
  }

  void place_ends() {
    list_moved();
    ends_.resize(moved_.size());
    parallel_.for_each(moved_.size(), points_per_task, [&](size_t i) {
      const Vec3d p = lattice_.to_lattice(mesh_.vertices[moved_[i]]);
      ends_[i] = field_.project(p, reach).value_or(p);
    });
  }

  void place_middles() {
    middles_.resize(edges_.size());
    split_.assign(edges_.size(), 0);
    parallel_.for_each(edges_.size(), points_per_task, [&](size_t i) {
      const Vec3d middle = 0.5 * (ends_[slot_[edges_[i].a]] + ends_[slot_[edges_[i].b]]);
      const auto on_surface = field_.project(middle, reach);
      if (!on_surface || !(norm(*on_surface - middle) > tolerance_)) return;
      middles_[i] = *on_surface;
      split_[i] = 1;
    });
  }

  /// Forgets the other edges, and vertices that end none; sorts edges by their lower end.
  void keep_split() {
    first_of_.assign(mesh_.vertices.size() + 1, 0);
    for (size_t i = 0; i < edges_.size(); ++i)
      if (split_[i]) ++first_of_[edges_[i].a + 1];
    for (size_t v = 1; v < first_of_.size(); ++v) first_of_[v] += first_of_[v - 1];
    std::vector<uint32_t> next(first_of_.begin(), first_of_.end() - 1);
    std::vector<Edge> edges(first_of_.back());
    std::vector<Vec3d> middles(edges.size());
    for (size_t i = 0; i < edges_.size(); ++i) {
      if (!split_[i]) continue;
      const uint32_t to = next[edges_[i].a]++;
      edges[to] = edges_[i];
      middles[to] = middles_[i];
    }
    edges_ = std::move(edges);
    middles_ = std::move(middles);
    const std::vector<uint32_t> old_slot = std::move(slot_);
    const std::vector<Vec3d> old_ends = std::move(ends_);
    list_moved();
    ends_.resize(moved_.size());
    for (size_t i = 0; i < moved_.size(); ++i) ends_[i] = old_ends[old_slot[moved_[i]]];
  }

  /// In the world, from the lattice.
  Vec3d settled(Vec3d point, const Leftover& leftover) const {
    if (const auto jet = field_.at(point)) {
      const Vec3d normal = normalized(jet->gradient);
      point += normal * leftover.mean_at(point, normal);
    }
    return lattice_.to_world(point);
  }

  /// The vertex in the middle of an edge; `none` where it is not split.
  uint32_t middle_of(uint32_t a, uint32_t b) const {
    if (slot_[a] == none || slot_[b] == none) return none;
    if (a > b) std::swap(a, b);
    for (uint32_t i = first_of_[a]; i < first_of_[a + 1]; ++i)
      if (edges_[i].b == b) return static_cast<uint32_t>(first_new_ + i);
    return none;
  }

  void cut_triangles() {
    const size_t old = mesh_.triangles.size();
    for (size_t t = 0; t < old; ++t) {
      Triangle corner = mesh_.triangles[t];
      std::array<uint32_t, 3> middle{};  // of the edge from corner k to the next
      int count = 0;
      for (size_t k = 0; k < 3; ++k) {
        middle[k] = middle_of(corner[k], corner[(k + 1) % 3]);
        count += middle[k] != none;
      }
      if (count == 0) continue;
      if (count < 3) {  // turn: one split edge is the first, two are the first and the second
        size_t turn = 0;
        while (count == 1 ? middle[turn] == none : middle[(turn + 2) % 3] != none) ++turn;
        std::rotate(corner.begin(), corner.begin() + static_cast<std::ptrdiff_t>(turn), corner.end());
        std::rotate(middle.begin(), middle.begin() + static_cast<std::ptrdiff_t>(turn), middle.end());
      }
      cut(t, corner, middle, count);
    }
  }

  void cut(size_t t, const Triangle& corner, const std::array<uint32_t, 3>& middle, int count) {
    const auto [a, b, c] = corner;
    const auto [ab, bc, ca] = middle;
    const auto put = [&](const Triangle& first, std::initializer_list<Triangle> others) {
      mesh_.triangles[t] = first;
      mesh_.triangles.insert(mesh_.triangles.end(), others);
    };
    if (count == 1) return put({a, ab, c}, {{ab, b, c}});
    if (count == 3) return put({ab, bc, ca}, {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}});
    // The shorter diagonal of the quadrilateral that is left.
    const auto length = [&](uint32_t p, uint32_t q) { return norm(mesh_.vertices[p] - mesh_.vertices[q]); };
    if (length(a, bc) <= length(ab, c)) return put({ab, b, bc}, {{a, ab, bc}, {a, bc, c}});
    put({ab, b, bc}, {{a, ab, c}, {ab, bc, c}});
  }

  /// Takes back, by half and in the end wholly, the moves of the corners of triangles that they turn too far: without
  /// them each part of a cut triangle lies in the triangle.
  void unfold() {
    std::vector<uint8_t> halvings(start_.size());
    const std::vector<Vec3d> target = mesh_.vertices;
    for (std::vector<uint32_t> folded = folded_corners(); !folded.empty(); folded = folded_corners())
      for (const uint32_t v : folded) {
        const double share = ++halvings[v] < most_halvings ? std::ldexp(1.0, -halvings[v]) : 0;
        mesh_.vertices[v] = start_[v] + (target[v] - start_[v]) * share;
        if (share == 0) mesh_.vertices[v] = start_[v];
      }
  }

  /// Of triangles that have turned too far, each one once, those that moved.
  std::vector<uint32_t> folded_corners() const {
    std::vector<std::vector<uint32_t>> found((mesh_.triangles.size() + triangles_per_task - 1) / triangles_per_task);
    const auto normal_of = [](const std::vector<Vec3d>& at, const Triangle& t) {
      return normalized(cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]));
    };
    parallel_.for_chunks(mesh_.triangles.size(), triangles_per_task, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Triangle& t = mesh_.triangles[i];
        if (dot(normal_of(start_, t), normal_of(mesh_.vertices, t)) > least_cosine) continue;
        for (const uint32_t v : t)
          if (!(mesh_.vertices[v] == start_[v])) found[begin / triangles_per_task].push_back(v);
      }
    });
    std::vector<uint32_t> corners;
    for (const auto& part : found) corners.insert(corners.end(), part.begin(), part.end());
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
  }

  Mesh& mesh_;
  const SmoothField& field_;
  const Lattice& lattice_;
  double tolerance_;
  const Parallel& parallel_;
  std::vector<Edge> edges_;
  std::vector<Vec3d> middles_;      // of the edges, lattice
  std::vector<uint8_t> split_;      // by edge
  std::vector<uint32_t> moved_;     // vertices that end an edge, ascending
  std::vector<uint32_t> slot_;      // by vertex: its place among them
  std::vector<Vec3d> ends_;         // their places, lattice
  std::vector<uint32_t> first_of_;  // by vertex: the first edge that it is the lower end of
  std::vector<Vec3d> start_;        // vertices, new ones too, before they move
  size_t first_new_ = 0;
};

}  // namespace

void validate(const BendParams& params) {
  if (!(params.tolerance >= 0 && params.tolerance <= 1))
    throw ParameterError(fmt::format("bend_tolerance = {}, must be in [0, 1]", params.tolerance));
}

void bend_edges(Mesh& mesh, const SmoothField& field, const GridSamples& samples, double scale, const Lattice& lattice,
                const BendParams& params, const Parallel& parallel, BendReport& report) {
  validate(params);
  report.triangles_before = mesh.triangles.size();
  // Half edges, and vertices with the new ones, are counted by 32 bits.
  if (params.tolerance == 0 || mesh.triangles.size() >= none / 3) return;
  const Leftover leftover(samples, field, scale, parallel);
  report.split_edges = Bending(mesh, field, lattice, params.tolerance, parallel).run(leftover);
}

}  // namespace soapfilm
