#include "soapfilm/mesh/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/triangle_normal.h"

namespace soapfilm {

namespace {

constexpr uint32_t nowhere = std::numeric_limits<uint32_t>::max();

/// Items listed per vertex: those of vertex v are items[first[v]] .. items[first[v + 1] - 1].
template <class Item>
struct PerVertex {
  std::vector<size_t> first;
  std::vector<Item> items;

  Item* begin(size_t vertex) { return items.data() + first[vertex]; }
  Item* end(size_t vertex) { return items.data() + first[vertex + 1]; }
};

/// Counting sort: for_all(add) calls add(vertex, item) for every item, the same ones in the same order each time.
template <class Item, class ForAll>
PerVertex<Item> group_by_vertex(size_t vertices, ForAll&& for_all) {
  PerVertex<Item> out;
  out.first.assign(vertices + 1, 0);
  for_all([&](uint32_t vertex, const Item&) { ++out.first[vertex + 1]; });
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.items.resize(out.first.back());
  std::vector<size_t> next(out.first.begin(), out.first.end() - 1);
  for_all([&](uint32_t vertex, const Item& item) { out.items[next[vertex]++] = item; });
  return out;
}

bool is_degenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

class Checker {
 public:
  explicit Checker(const Mesh& mesh) : mesh_(mesh), sets_(mesh.vertices.size()), faulty_(mesh.vertices.size(), 0) {}

  TopologyReport run() {
    report_.vertices = mesh_.vertices.size();
    report_.triangles = mesh_.triangles.size();
    check_triangles();
    check_edges();
    check_fans();
    check_duplicates();
    collect_components();
    return std::move(report_);
  }

 private:
  /// An edge towards a higher vertex; `forward` when its triangle runs from the lower vertex to the higher.
  struct HalfEdge {
    uint32_t to;
    bool forward;
  };
  using Link = std::array<uint32_t, 2>;  // a triangle's other two vertices

  template <class Visit>
  void for_triangles(Visit&& visit) const {
    for (const Triangle& t : mesh_.triangles) {
      if (!is_degenerate(t)) visit(t);
    }
  }

  void check_triangles() {
    for (size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Triangle& t = mesh_.triangles[i];
      const uint32_t highest = std::max({t[0], t[1], t[2]});
      if (highest >= mesh_.vertices.size()) {
        throw ParameterError(
            fmt::format("triangle {} names vertex {}, must be < {}", i, highest, mesh_.vertices.size()));
      }
      if (is_degenerate(t)) {
        ++report_.degenerate_triangles;
        continue;
      }
      sets_.join(t[0], t[1]);
      sets_.join(t[1], t[2]);
      const Vec3d corner = mesh_.vertices[t[0]];
      if (!has_area(mesh_.vertices[t[1]] - corner, mesh_.vertices[t[2]] - corner)) ++report_.zero_area_triangles;
    }
  }

  void check_edges() {
    auto edges = group_by_vertex<HalfEdge>(mesh_.vertices.size(), [this](auto&& add) {
      for_triangles([&](const Triangle& t) {
        for (int k = 0; k < 3; ++k) {
          const uint32_t from = t[k];
          const uint32_t to = t[(k + 1) % 3];
          add(std::min(from, to), HalfEdge{std::max(from, to), from < to});
        }
      });
    });
    edges_at_.assign(mesh_.vertices.size(), 0);
    for (size_t v = 0; v < mesh_.vertices.size(); ++v) {
      std::sort(edges.begin(v), edges.end(v), [](HalfEdge a, HalfEdge b) { return a.to < b.to; });
      for (const HalfEdge* e = edges.begin(v); e != edges.end(v);) {
        const HalfEdge* end = std::find_if(e, static_cast<const HalfEdge*>(edges.end(v)),
                                           [e](HalfEdge other) { return other.to != e->to; });
        judge_edge(v, e, end);
        e = end;
      }
    }
  }

  /// Checks all half-edges between two vertices.
  void judge_edge(size_t vertex, const HalfEdge* begin, const HalfEdge* end) {
    ++report_.edges;
    ++edges_at_[vertex];
    const auto count = end - begin;
    const auto forward = std::count_if(begin, end, [](HalfEdge e) { return e.forward; });
    if (count == 2 && forward == 1) return;
    faulty_[vertex] = 1;
    if (count == 1) ++report_.boundary_edges;
    if (count == 2) ++report_.misoriented_edges;
    if (count > 2) ++report_.non_manifold_edges;
  }

  void check_fans() {
    auto links = group_by_vertex<Link>(mesh_.vertices.size(), [this](auto&& add) {
      for_triangles([&](const Triangle& t) {
        for (int k = 0; k < 3; ++k) add(t[k], Link{t[(k + 1) % 3], t[(k + 2) % 3]});
      });
    });
    for (size_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (links.begin(v) == links.end(v)) ++report_.unreferenced_vertices;
      if (count_fans(links.begin(v), links.end(v)) <= 1) continue;
      ++report_.non_manifold_vertices;
      faulty_[v] = 1;
    }
  }

  /// Triangles around a vertex that share an edge at it belong to one fan. Follows a fan from triangle to triangle by
  /// moving its triangles to the front; valences are small, so the quadratic search is the fast one.
  static size_t count_fans(Link* begin, Link* end) {
    if (end - begin > 64) return count_fans_of_hub(begin, end);
    size_t fans = 0;
    for (Link* done = begin; done != end; ++fans) {
      Link* fan_end = done + 1;
      for (; done != fan_end; ++done) {
        const Link here = *done;
        fan_end = std::partition(fan_end, end, [here](const Link& other) {
          return other[0] == here[0] || other[0] == here[1] || other[1] == here[0] || other[1] == here[1];
        });
      }
    }
    return fans;
  }

  /// The same for a vertex of high valence: union-find over its sorted neighbors.
  static size_t count_fans_of_hub(const Link* begin, const Link* end) {
    std::vector<uint32_t> ring;
    for (const Link* link = begin; link != end; ++link) ring.insert(ring.end(), link->begin(), link->end());
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    DisjointSets sets(ring.size());
    const auto place = [&](uint32_t vertex) {
      return static_cast<uint32_t>(std::lower_bound(ring.begin(), ring.end(), vertex) - ring.begin());
    };
    size_t fans = ring.size();
    for (const Link* link = begin; link != end; ++link)
      if (sets.join(place((*link)[0]), place((*link)[1]))) --fans;
    return fans;
  }

  void check_duplicates() {
    auto pairs = group_by_vertex<Link>(mesh_.vertices.size(), [this](auto&& add) {
      for_triangles([&](Triangle t) {
        std::sort(t.begin(), t.end());
        add(t[0], Link{t[1], t[2]});
      });
    });
    for (size_t v = 0; v < mesh_.vertices.size(); ++v) {
      std::sort(pairs.begin(v), pairs.end(v));
      for (const Link* p = pairs.begin(v); p != pairs.end(v); ++p) {
        if (p != pairs.begin(v) && p[0] == p[-1]) ++report_.duplicate_triangles;
      }
    }
  }

  void collect_components() {
    std::vector<uint32_t> component(mesh_.vertices.size(), nowhere);
    std::vector<uint8_t> used(mesh_.vertices.size(), 0);
    for_triangles([&](const Triangle& t) {
      for (const uint32_t v : t) used[v] = 1;
    });
    for (uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (!used[v]) continue;
      const uint32_t r = sets_.root(v);
      if (component[r] == nowhere) {
        component[r] = static_cast<uint32_t>(report_.components.size());
        report_.components.emplace_back();
      }
      MeshComponent& c = report_.components[component[r]];
      ++c.vertices;
      c.edges += edges_at_[v];
      if (faulty_[v]) c.closed_manifold = false;
    }
    for_triangles([&](const Triangle& t) { ++report_.components[component[sets_.root(t[0])]].triangles; });
  }

  const Mesh& mesh_;
  TopologyReport report_;
  DisjointSets sets_;               // of connected vertices
  std::vector<uint32_t> edges_at_;  // edges whose lower vertex this is
  std::vector<uint8_t> faulty_;     // vertices at which the surface is not a closed, oriented manifold
};

}  // namespace

int64_t MeshComponent::euler_characteristic() const {
  return static_cast<int64_t>(vertices) - static_cast<int64_t>(edges) + static_cast<int64_t>(triangles);
}

std::optional<int64_t> MeshComponent::genus() const {
  if (!closed_manifold) return std::nullopt;
  return (2 - euler_characteristic()) / 2;
}

int64_t TopologyReport::euler_characteristic() const {
  int64_t sum = 0;
  for (const MeshComponent& c : components) sum += c.euler_characteristic();
  return sum;
}

std::optional<int64_t> TopologyReport::genus() const {
  int64_t sum = 0;
  for (const MeshComponent& c : components) {
    if (!c.closed_manifold) return std::nullopt;
    sum += *c.genus();
  }
  return sum;
}

bool TopologyReport::manifold() const {
  return non_manifold_edges == 0 && misoriented_edges == 0 && non_manifold_vertices == 0 && duplicate_triangles == 0 &&
         degenerate_triangles == 0;
}

bool TopologyReport::watertight() const {
  return closed() && manifold() && zero_area_triangles == 0 && unreferenced_vertices == 0;
}

TopologyReport check_topology(const Mesh& mesh) { return Checker(mesh).run(); }

std::string summary(const TopologyReport& report) {
  std::string line = fmt::format("{}, {}, {} component{}", report.closed() ? "closed" : "not closed",
                                 report.manifold() ? "manifold" : "not manifold", report.components.size(),
                                 report.components.size() == 1 ? "" : "s");
  if (const auto genus = report.genus(); genus && !report.components.empty()) line += fmt::format(", genus {}", *genus);
  const std::pair<size_t, const char*> faults[] = {
      {report.boundary_edges, "boundary edges"},           {report.non_manifold_edges, "non-manifold edges"},
      {report.misoriented_edges, "misoriented edges"},     {report.non_manifold_vertices, "non-manifold vertices"},
      {report.duplicate_triangles, "duplicate triangles"}, {report.degenerate_triangles, "degenerate triangles"},
      {report.zero_area_triangles, "zero-area triangles"}, {report.unreferenced_vertices, "unreferenced vertices"},
  };
  for (const auto& [count, name] : faults) {
    if (count > 0) line += fmt::format(", {} {}", count, name);
  }
  return line;
}

}  // namespace soapfilm
