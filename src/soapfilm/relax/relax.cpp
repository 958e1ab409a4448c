#include "soapfilm/relax/relax.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "soapfilm/core/indices.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"
#include "soapfilm/error.h"
#include "soapfilm/relax/crossings.h"
#include "soapfilm/relax/flip.h"
#include "soapfilm/relax/half_edges.h"
#include "soapfilm/relax/residuals.h"
#include "soapfilm/relax/untangle.h"

namespace soapfilm {

namespace {

constexpr double reach = 0.25;        // voxels, the most that a vertex moves onto the smooth surface
constexpr double suspicion = 0.33;    // of the tolerance: edges with a larger sag by the ends' normals are measured
constexpr double least_gain = 0.004;  // voxels
constexpr size_t half_edges_per_task = 1 << 15;
constexpr size_t points_per_task = 1 << 10;
constexpr uint32_t none = ~uint32_t{0};

/// Normal of the smooth surface at a lattice point; zero where unknown.
Vec3d normal_at(const SmoothField& field, Vec3d point) {
  const auto jet = field.at(point);
  return jet ? normalized(jet->gradient) : Vec3d{};
}

/// Along the world's axes.
std::vector<Vec3f> vertex_normals(const Mesh& mesh, const SmoothField& field, const Lattice& lattice,
                                  const Context& context) {
  std::vector<Vec3f> normals(mesh.vertices.size());
  share_values(normals, points_per_task, context, [&](size_t v) {
    normals[v] = lattice.to_world_axes(Vec3f(normal_at(field, lattice.to_lattice(mesh.vertices[v]))));
  });
  return normals;
}

class Relaxation {
 public:
  Relaxation(Mesh& mesh, const SmoothField& field, const Lattice& lattice, double tolerance, const Context& context)
      : mesh_(mesh), field_(field), lattice_(lattice), tolerance_(tolerance), context_(context) {}

  size_t run(const Residuals& leftover) {
    const std::vector<Vec3d> start = move_vertices(leftover);
    context_.progress().advance(0.8, "vertices moved");
    untangle(mesh_, start, lattice_.voxel, context_);
    return start.size() - old_;
  }

 private:
  /// Returns the previous positions of the vertices, including new ones.
  std::vector<Vec3d> move_vertices(const Residuals& leftover) {
    const std::vector<Vec3f> normals = vertex_normals(mesh_, field_, lattice_, context_);
    const HalfEdges edges = flipped(normals);
    context_.progress().advance(0.5, "diagonals exchanged");
    find_suspects(edges, normals);
    place_ends(edges);
    place_middles(edges);
    context_.progress().advance(0.7, "edges split");
    old_ = mesh_.vertices.size();
    require_indices(old_ + split_.size(), most_indices, "vertices of the surface");
    require_indices(mesh_.triangles.size() + 2 * split_.size(), most_triangles, "triangles of the surface");
    std::vector<Vec3d> start;
    start.reserve(old_ + split_.size());
    start = mesh_.vertices;
    for (const uint32_t h : split_) start.push_back(0.5 * (start[edges.from(h)] + start[edges.to(h)]));
    mesh_.vertices.resize(start.size());
    place_vertices(leftover, start, normals);
    release(ends_);
    cut_triangles(edges);
    return start;
  }

  void place_vertices(const Residuals& leftover, std::span<const Vec3d> start, std::span<const Vec3f> normals) {
    const auto place = [&](size_t v) {
      const bool stays = v < old_ && !is_end_[v];
      const Vec3d p = v >= old_ ? middles_[v - old_] : stays ? lattice_.to_lattice(start[v]) : ends_[v];
      const Vec3d normal = stays ? Vec3d(lattice_.from_world_axes(normals[v])) : normal_at(field_, p);
      mesh_.vertices[v] = lattice_.to_world(p + normal * leftover.mean_at(p, normal));
    };
    // Old and new vertices one after the other, so that each rank stays in its part of space.
    share_items(
        old_, mesh_.vertices, points_per_task, context_, [](size_t v) { return v; }, place);
    const auto number_of = [this](size_t k) { return old_ + k; };
    share_items(split_.size(), mesh_.vertices, points_per_task, context_, number_of,
                [&](size_t k) { place(number_of(k)); });
  }

  /// Exchanges diagonals, except near places where that would make the mesh intersect itself: farther and farther
  /// around them if such places keep appearing.
  HalfEdges flipped(std::vector<Vec3f> normals) {
    constexpr int most_tries = 12, tries_at_the_places = 4;
    const std::vector<Triangle> before = mesh_.triangles;
    std::vector<Triangle> failed;  // triangles of intersecting pairs that were already handled
    for (int tries = 0; tries < most_tries; ++tries) {
      HalfEdges edges(mesh_, context_);
      flip_edges(edges, normals, lattice_.voxel, least_gain * lattice_.voxel, context_);
      const std::vector<Triangle>& known = failed.empty() ? before : failed;
      std::vector<uint8_t> changed(before.size());
      for (size_t t = 0; t < before.size(); ++t) changed[t] = mesh_.triangles[t] != known[t];
      const MeshChange change{before, mesh_.triangles, mesh_.vertices, mesh_.vertices, changed};
      const auto pairs = CrossingSearch(change, lattice_.voxel, context_).find(mesh_.vertices, changed);
      if (pairs.empty()) return edges;
      for (const auto& pair : pairs)
        for (const uint32_t t : pair)
          for (const uint32_t v : mesh_.triangles[t])
            normals[v] = {};  // flip_edges() ignores vertices with unknown normals
      for (int ring = tries_at_the_places; ring < tries; ++ring) spread_unknown(normals);
      failed = std::exchange(mesh_.triangles, before);
    }
    return HalfEdges(mesh_, context_);
  }

  /// To the other corners of the triangles there.
  void spread_unknown(std::vector<Vec3f>& normals) const {
    std::vector<uint32_t> beside;
    for (const Triangle& t : mesh_.triangles)
      if (std::any_of(t.begin(), t.end(), [&](uint32_t v) { return normals[v] == Vec3f{}; }))
        beside.insert(beside.end(), t.begin(), t.end());
    for (const uint32_t v : beside) normals[v] = {};
  }

  /// Edges that may lie too far from the surface, by the half that runs upwards.
  void find_suspects(const HalfEdges& edges, std::span<const Vec3f> normals) {
    const double limit = suspicion * tolerance_ * lattice_.voxel;
    split_ = share_gather<uint32_t>(edges.size(), half_edges_per_task, context_,
                                    [&](size_t i, std::vector<uint32_t>& found) {
                                      const auto h = static_cast<uint32_t>(i);
                                      const uint32_t a = edges.from(h), b = edges.to(h);
                                      if (a < b && !edges.on_boundary(h) &&
                                          sag(mesh_.vertices[a], mesh_.vertices[b], normals[a], normals[b]) > limit)
                                        found.push_back(h);
                                    });
  }

  void mark_ends(const HalfEdges& edges) {
    is_end_.assign(mesh_.vertices.size(), 0);
    for (const uint32_t h : split_) is_end_[edges.from(h)] = is_end_[edges.to(h)] = 1;
  }

  void place_ends(const HalfEdges& edges) {
    mark_ends(edges);
    ends_.resize(mesh_.vertices.size());
    share_values(ends_, points_per_task, context_, [&](size_t v) {
      if (!is_end_[v]) return;
      ends_[v] = lattice_.to_lattice(mesh_.vertices[v]);
      ends_[v] = field_.project(ends_[v], reach).value_or(ends_[v]);
    });
  }

  /// Removes the suspects that lie near enough, and their ends.
  void place_middles(const HalfEdges& edges) {
    struct Middle {
      uint32_t half_edge;
      Vec3d place;
    };
    const auto found =
        share_gather<Middle>(split_.size(), points_per_task, context_, [&](size_t i, std::vector<Middle>& to) {
          const Vec3d middle = 0.5 * (ends_[edges.from(split_[i])] + ends_[edges.to(split_[i])]);
          const auto on_surface = field_.project(middle, reach);
          if (on_surface && norm(*on_surface - middle) > tolerance_) to.push_back({split_[i], *on_surface});
        });
    split_.clear();
    middles_.clear();
    for (const Middle& m : found) {
      split_.push_back(m.half_edge);
      middles_.push_back(m.place);
    }
    mark_ends(edges);
  }

  void cut_triangles(const HalfEdges& edges) {
    std::vector<uint32_t> middle_of(edges.size(), none);  // vertices, by half edge
    for (size_t i = 0; i < split_.size(); ++i)
      middle_of[split_[i]] = middle_of[edges.twin(split_[i])] = static_cast<uint32_t>(old_ + i);
    const size_t count_before = mesh_.triangles.size();
    mesh_.triangles.reserve(count_before + 2 * split_.size());
    for (size_t t = 0; t < count_before; ++t) {
      Triangle corner = mesh_.triangles[t];
      std::array<uint32_t, 3> middle{middle_of[3 * t], middle_of[3 * t + 1], middle_of[3 * t + 2]};
      const auto count = 3 - std::count(middle.begin(), middle.end(), none);
      if (count == 0) continue;
      if (count < 3) {  // rotate: one split edge comes first, two come first and second
        size_t turn = 0;
        while (count == 1 ? middle[turn] == none : middle[(turn + 2) % 3] != none) ++turn;
        std::rotate(corner.begin(), corner.begin() + static_cast<std::ptrdiff_t>(turn), corner.end());
        std::rotate(middle.begin(), middle.begin() + static_cast<std::ptrdiff_t>(turn), middle.end());
      }
      cut(t, corner, middle, count);
    }
  }

  void cut(size_t t, const Triangle& corner, const std::array<uint32_t, 3>& middle, std::ptrdiff_t count) {
    const auto [a, b, c] = corner;
    const auto [ab, bc, ca] = middle;
    const auto put = [&](const Triangle& first, std::initializer_list<Triangle> others) {
      mesh_.triangles[t] = first;
      mesh_.triangles.insert(mesh_.triangles.end(), others);
    };
    if (count == 1) return put({a, ab, c}, {{ab, b, c}});
    if (count == 3) return put({ab, bc, ca}, {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}});
    // The shorter diagonal of the remaining quadrilateral.
    const auto length = [&](uint32_t p, uint32_t q) { return norm(mesh_.vertices[p] - mesh_.vertices[q]); };
    if (length(a, bc) <= length(ab, c)) return put({ab, b, bc}, {{a, ab, bc}, {a, bc, c}});
    put({ab, b, bc}, {{a, ab, c}, {ab, bc, c}});
  }

  Mesh& mesh_;
  const SmoothField& field_;
  const Lattice& lattice_;
  double tolerance_;
  const Context& context_;
  size_t old_ = 0;               // vertices before any was added
  std::vector<uint32_t> split_;  // half edges: suspects at first, then those that are split
  std::vector<Vec3d> middles_;   // of those, lattice
  std::vector<uint8_t> is_end_;  // by vertex: ends one of them
  std::vector<Vec3d> ends_;      // by vertex: position of such an end, lattice
};

}  // namespace

void validate(const RelaxParams& params) {
  if (!(params.split_tolerance >= 0 && params.split_tolerance <= 1))
    throw ParameterError(fmt::format("split_tolerance = {}, must be in [0, 1]", params.split_tolerance));
}

RelaxReport relax_mesh(Mesh& mesh, const SmoothField& field, const GridSamples& samples, double scale,
                       const Lattice& lattice, const RelaxParams& params, const Context& context) {
  validate(params);
  RelaxReport report;
  report.triangles_before = mesh.triangles.size();
  if (params.split_tolerance == 0 || mesh.triangles.empty() || mesh.triangles.size() > most_relaxed) return report;
  const Residuals leftover(samples, field, scale, context);
  report.split_edges = Relaxation(mesh, field, lattice, params.split_tolerance, context).run(leftover);
  return report;
}

}  // namespace soapfilm
