#include "soapfilm/remesh/features.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "soapfilm/remesh/sharp_edges.h"

namespace soapfilm {

namespace {

constexpr uint32_t none = Features::none;
constexpr double turn_cosine = 0.643;  // of 50 degrees, between the directions of a chain
constexpr double shortest_spur = 3;    // edges: shorter ones that end in the surface are noise
constexpr double shortest_ring = 4;

/// The marked edges at each vertex.
class FeatureGraph {
 public:
  struct Way {
    uint32_t to, half_edge;
  };

  FeatureGraph(const Connectivity& mesh, const std::vector<uint8_t>& marked, size_t vertices) : begin_(vertices + 1) {
    const auto for_all = [&](auto&& visit) {
      for (uint32_t h = 0; h < marked.size(); ++h)
        if (marked[h] && (mesh.twin(h) == none || h < mesh.twin(h))) visit(h);
    };
    for_all([&](uint32_t h) {
      ++begin_[mesh.from(h) + 1];
      ++begin_[mesh.to(h) + 1];
    });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    ways_.resize(begin_.back());
    std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
    for_all([&](uint32_t h) {
      ways_[next[mesh.from(h)]++] = {mesh.to(h), h};
      ways_[next[mesh.to(h)]++] = {mesh.from(h), h};
    });
  }

  size_t vertices() const { return begin_.size() - 1; }
  uint32_t degree(uint32_t v) const { return begin_[v + 1] - begin_[v]; }
  Way way(uint32_t v, uint32_t i) const { return ways_[begin_[v] + i]; }

 private:
  std::vector<uint32_t> begin_;
  std::vector<Way> ways_;
};

struct Path {
  std::vector<uint32_t> vertex, half_edge;
  bool is_ring() const { return vertex.front() == vertex.back(); }
};

class PathFinder {
 public:
  PathFinder(const FeatureGraph& graph, size_t half_edges) : graph_(graph), taken_(half_edges) {}

  /// Between vertices of another degree than two; then rings.
  std::vector<Path> all() {
    std::vector<Path> paths;
    for (const bool rings : {false, true})
      for (uint32_t v = 0; v < graph_.vertices(); ++v)
        for (uint32_t i = 0; i < graph_.degree(v) && (rings || graph_.degree(v) != 2); ++i)
          if (!taken_[graph_.way(v, i).half_edge]) paths.push_back(from(v, i));
    return paths;
  }

 private:
  Path from(uint32_t start, uint32_t i) {
    Path path{{start}, {}};
    for (FeatureGraph::Way way = graph_.way(start, i);;) {
      taken_[way.half_edge] = 1;
      path.vertex.push_back(way.to);
      path.half_edge.push_back(way.half_edge);
      if (way.to == start || graph_.degree(way.to) != 2) return path;
      const FeatureGraph::Way other = graph_.way(way.to, 0);
      way = other.half_edge == way.half_edge ? graph_.way(way.to, 1) : other;
    }
  }

  const FeatureGraph& graph_;
  std::vector<uint8_t> taken_;
};

/// Takes short cuts along the third edge of a triangle where the path runs to and fro, as at the tip of an ear.
class ShortCuts {
 public:
  ShortCuts(const Connectivity& mesh, const std::vector<Vec3d>& position, const FeatureGraph& graph, double edge)
      : mesh_(mesh), position_(position), graph_(graph), edge_(edge) {}

  void take(Path& path) const {
    for (size_t i = 0; i + 1 < path.half_edge.size() && path.half_edge.size() > 3;) {
      const uint32_t third = short_cut(path, i);
      if (third == none) {
        ++i;
        continue;
      }
      path.vertex.erase(path.vertex.begin() + static_cast<ptrdiff_t>(i) + 1);
      path.half_edge.erase(path.half_edge.begin() + static_cast<ptrdiff_t>(i));
      path.half_edge[i] = third;
      i -= i > 0;
    }
  }

 private:
  /// Of the edges i and i + 1: the half edge that joins their ends, or none.
  uint32_t short_cut(const Path& path, size_t i) const {
    constexpr double straight = 0.5, aside = 0.1;  // the cosine of 60 degrees; of an edge
    const Vec3d a = position_[path.vertex[i]], b = position_[path.vertex[i + 1]], c = position_[path.vertex[i + 2]];
    const Vec3d in = b - a, out = c - b, ends = c - a;
    if (dot(in, out) > straight * norm(in) * norm(out)) return none;
    if (norm(cross(in, out)) > aside * edge_ * norm(ends) || std::min(norm(in), norm(out)) > edge_) return none;
    for (const uint32_t h : {path.half_edge[i], mesh_.twin(path.half_edge[i])}) {
      if (h == none) return none;
      const uint32_t x = Connectivity::next(h), y = Connectivity::previous(h);
      const uint32_t other = path.half_edge[i + 1];
      const uint32_t third = is_edge(x, other) ? y : is_edge(y, other) ? x : none;
      if (third != none && graph_.degree(path.vertex[i + 2]) == 2) return third;
    }
    return none;
  }
  bool is_edge(uint32_t h, uint32_t g) const { return h == g || mesh_.twin(h) == g; }

  const Connectivity& mesh_;
  const std::vector<Vec3d>& position_;
  const FeatureGraph& graph_;
  double edge_;
};

std::vector<double> lengths_along(const Path& path, const std::vector<Vec3d>& position) {
  std::vector<double> at{0};
  for (size_t i = 1; i < path.vertex.size(); ++i)
    at.push_back(at.back() + norm(position[path.vertex[i]] - position[path.vertex[i - 1]]));
  return at;
}

/// Vertices of sharp edges that are rounded move to where they belong.
std::vector<Vec3d> sharpened_vertices(const Connectivity& mesh, const std::vector<Vec3d>& position, const Sides& sides,
                                      const std::vector<Path>& paths) {
  std::vector<Vec3d> sharp = position;
  for (const Path& path : paths)
    for (const uint32_t v : path.vertex) {
      bool rounded = false;
      mesh.for_fan(v, [&](uint32_t h) { rounded = rounded || sides.is_rounded(h / 3); });
      if (rounded && !mesh.on_border(v)) sharp[v] = sides.sharpened(position[v]);
    }
  return sharp;
}

Vec3d on_path(const Path& path, const std::vector<double>& at, const std::vector<Vec3d>& position, double along) {
  if (path.is_ring()) along = along < 0 ? along + at.back() : along > at.back() ? along - at.back() : along;
  along = std::clamp(along, 0.0, at.back());
  const auto i = std::clamp<size_t>(std::upper_bound(at.begin(), at.end(), along) - at.begin(), 1, at.size() - 1);
  const double step = at[i] - at[i - 1];
  const Vec3d a = position[path.vertex[i - 1]], b = position[path.vertex[i]];
  return step > 0 ? a + (b - a) * ((along - at[i - 1]) / step) : a;
}

/// Where it turns most, no two within `edge`, and none so near to its ends.
std::vector<size_t> turns(const Path& path, const std::vector<double>& at, const std::vector<Vec3d>& position,
                          double edge) {
  struct Turn {
    double cosine;
    size_t index;
  };
  std::vector<Turn> found;
  for (size_t i = path.is_ring() ? 0 : 1; i + 1 < path.vertex.size(); ++i) {
    if (!path.is_ring() && std::min(at[i], at.back() - at[i]) < edge) continue;
    const Vec3d p = position[path.vertex[i]];
    const Vec3d in = normalized(p - on_path(path, at, position, at[i] - edge));
    const Vec3d out = normalized(on_path(path, at, position, at[i] + edge) - p);
    if (dot(in, out) < turn_cosine) found.push_back({dot(in, out), i});
  }
  std::stable_sort(found.begin(), found.end(), [](const Turn& a, const Turn& b) { return a.cosine < b.cosine; });
  std::vector<size_t> kept;
  for (const Turn& turn : found)
    if (std::none_of(kept.begin(), kept.end(), [&](size_t k) {
          const double apart = std::abs(at[k] - at[turn.index]);
          return std::min(apart, path.is_ring() ? at.back() - apart : apart) < edge;
        }))
      kept.push_back(turn.index);
  std::sort(kept.begin(), kept.end());
  return kept;
}

/// So that it begins at the vertex of that index.
Path turned_ring(const Path& ring, size_t begin) {
  Path turned;
  const size_t n = ring.half_edge.size();
  for (size_t i = 0; i <= n; ++i) turned.vertex.push_back(ring.vertex[(begin + i) % n]);
  for (size_t i = 0; i < n; ++i) turned.half_edge.push_back(ring.half_edge[(begin + i) % n]);
  return turned;
}

class ChainMaker {
 public:
  ChainMaker(const Connectivity& mesh, const std::vector<Vec3d>& position, Features& features)
      : mesh_(mesh), position_(position), features_(features) {}

  /// Cuts the path at turns; a ring, at least in three.
  void add(Path path, double edge) {
    std::vector<double> at = lengths_along(path, position_);
    std::vector<size_t> cuts = turns(path, at, position_, edge);
    if (path.is_ring() && !cuts.empty()) {
      path = turned_ring(path, cuts.front());
      at = lengths_along(path, position_);
      const size_t first = cuts.front();
      cuts.erase(cuts.begin());
      for (size_t& cut : cuts) cut -= first;
    }
    cuts.insert(cuts.begin(), 0);
    cuts.push_back(path.half_edge.size());
    if (path.is_ring() && cuts.size() < 4) cuts = thirds(at);
    for (size_t i = 0; i + 1 < cuts.size(); ++i) add_part(path, cuts[i], cuts[i + 1]);
  }

 private:
  static std::vector<size_t> thirds(const std::vector<double>& at) {
    const size_t last = at.size() - 1;
    const auto nearest = [&](double along, size_t lo, size_t hi) {
      const auto i = static_cast<size_t>(std::lower_bound(at.begin(), at.end(), along) - at.begin());
      return std::clamp(i, lo, hi);
    };
    const size_t first = nearest(at.back() / 3, 1, last - 2);
    return {0, first, nearest(at.back() * 2 / 3, first + 1, last - 1), last};
  }

  void add_part(const Path& path, size_t begin, size_t end) {
    Chain chain;
    const auto number = static_cast<uint32_t>(features_.chains.size());
    double along = 0;
    for (size_t i = begin; i <= end; ++i) {
      const uint32_t v = path.vertex[i];
      if (i > begin) along += norm(position_[v] - chain.point.back());
      chain.vertex.push_back(v);
      chain.point.push_back(position_[v]);
      chain.at.push_back(along);
    }
    for (size_t i = begin; i < end; ++i) {
      const uint32_t h = path.half_edge[i], g = mesh_.twin(h);
      features_.chain_of_edge[h] = number;
      if (g != none) features_.chain_of_edge[g] = number;
      chain.border = chain.border || g == none;
    }
    for (const uint32_t v : {path.vertex[begin], path.vertex[end]}) {
      if (!features_.is_corner[v]) features_.corners.push_back({v, position_[v]});
      features_.is_corner[v] = 1;
    }
    features_.chains.push_back(std::move(chain));
  }

  const Connectivity& mesh_;
  const std::vector<Vec3d>& position_;
  Features& features_;
};

}  // namespace

Vec3d Chain::place(double along) const {
  along = std::clamp(along, 0.0, length());
  const auto i = std::clamp<size_t>(std::upper_bound(at.begin(), at.end(), along) - at.begin(), 1, at.size() - 1);
  const double step = at[i] - at[i - 1];
  return step > 0 ? point[i - 1] + (point[i] - point[i - 1]) * ((along - at[i - 1]) / step) : point[i - 1];
}

Features find_features(const Connectivity& mesh, const std::vector<Vec3d>& position, const Sides& sides, double edge) {
  std::vector<uint8_t> marked = sharp_edges(mesh, sides, edge);
  std::vector<Path> paths;
  // A spur that goes may leave another one.
  constexpr int most_passes = 4;
  for (int pass = 0; pass < most_passes; ++pass) {
    const FeatureGraph graph(mesh, marked, position.size());
    paths = PathFinder(graph, marked.size()).all();
    bool changed = false;
    for (const Path& path : paths) {
      if (std::any_of(path.half_edge.begin(), path.half_edge.end(), [&](uint32_t h) { return mesh.twin(h) == none; }))
        continue;
      const double length = lengths_along(path, position).back();
      const bool ends = graph.degree(path.vertex.front()) == 1 || graph.degree(path.vertex.back()) == 1;
      if (!(ends && length < shortest_spur * edge) && !(path.is_ring() && length < shortest_ring * edge)) continue;
      for (const uint32_t h : path.half_edge) marked[h] = marked[mesh.twin(h)] = 0;
      changed = true;
    }
    if (!changed) break;
    paths.clear();
  }
  const FeatureGraph graph(mesh, marked, position.size());
  if (paths.empty()) paths = PathFinder(graph, marked.size()).all();
  Features features{{}, std::vector<uint32_t>(marked.size(), none), std::vector<uint8_t>(position.size()), {}};
  const std::vector<Vec3d> sharp = sharpened_vertices(mesh, position, sides, paths);
  ChainMaker maker(mesh, sharp, features);
  const ShortCuts short_cuts(mesh, sharp, graph, edge);
  for (Path& path : paths) {
    short_cuts.take(path);
    maker.add(std::move(path), edge);
  }
  return features;
}

}  // namespace soapfilm
