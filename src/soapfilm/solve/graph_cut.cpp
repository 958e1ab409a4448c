#include "soapfilm/solve/graph_cut.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/solve/dense_level.h"
#include "soapfilm/solve/min_cut.h"
#include "soapfilm/solve/outside_parts.h"

namespace soapfilm {

namespace {

/// Share of the sphere that is nearest to one of the 26 directions: with 1, 2, 3 steps along the axes.
constexpr double share_of_sphere[4] = {0, 0.04577789120476, 0.03698062787608, 0.03519563978232};

constexpr int first_dilation = 1;
constexpr int first_growth = 8;

/// Visits a brick's vertices in a mask: 64 rows.
template <class Visit>
void for_each_brick_row(Vec3i brick, Visit&& visit) {
  for (int r = 0; r < brick_area; ++r)
    visit(brick_side * brick.y + r % brick_side, brick_side * brick.z + r / brick_side, r);
}

VertexMask free_vertices(const LevelBox& box) {
  VertexMask mask(box.bricks);
  for (int z = box.free_lo.z; z <= box.free_hi.z; ++z)
    for (int y = box.free_lo.y; y <= box.free_hi.y; ++y)
      for (int x = box.free_lo.x; x <= box.free_hi.x; ++x) mask.set({x, y, z});
  return mask;
}

VertexMask vertices_with_data(const SupportField& support, const LevelBox& box) {
  VertexMask mask(box.bricks);
  for (size_t b = 0; b < support.grid.size(); ++b) {
    const float* f = support.f.brick(b);
    for_each_brick_row(support.grid.coord(b), [&](int y, int z, int r) {
      for (int x = 0; x < brick_side; ++x)
        if (f[brick_side * r + x] != 0) mask.set({brick_side * support.grid.coord(b).x + x, y, z});
    });
  }
  return mask;
}

VertexMask labels_of(const BandGraph& graph, const MinCut& cut, Vec3i bricks) {
  VertexMask inside(bricks);
  BandGraph::Cursor cursor(graph);
  for (BandVertex v; cursor.next(v);)
    if (cut.inside[v.id]) inside.set(v.position);
  return inside;
}

double energy_of(const BandGraph& graph, const MinCut& cut) {
  double energy = 0;
  BandGraph::Cursor cursor(graph);
  for (BandVertex v; cursor.next(v);) {
    if (!cut.inside[v.id]) continue;
    energy += v.unary;
    for (size_t d = 0; d < graph.links().size(); ++d)
      if (v.links >> d & 1u && !cut.inside[v.neighbor[d]]) energy += graph.links()[d].weight;
  }
  return energy;
}

struct Flood {
  VertexMask reached;
  bool all = false;  ///< whatever can be reached is
};

/// The free vertices outside the band that at most `reach` links connect to `sources` without crossing the band.
Flood flooded(const VertexMask& sources, const VertexMask& band, const LevelBox& box, const std::vector<Link>& links,
              int reach) {
  VertexMask reached(band.bricks());
  std::vector<Vec3i> front, next;
  sources.for_each([&](Vec3i v) { front.push_back(v); });
  for (int step = 0; step < reach && !front.empty(); ++step) {
    next.clear();
    for (const Vec3i v : front)
      for (const Link& link : links) {
        const Vec3i to = v + link.step;
        if (!box.is_free(to) || band.test(to) || reached.test(to)) continue;
        reached.set(to);
        next.push_back(to);
      }
    front.swap(next);
  }
  return {std::move(reached), front.empty()};
}

/// Those of the vertices that have a link to a fixed one.
VertexMask beside_fixed(const VertexMask& vertices, const LevelBox& box, const std::vector<Link>& links) {
  VertexMask beside(vertices.bricks());
  vertices.for_each([&](Vec3i v) {
    if (std::any_of(links.begin(), links.end(), [&](const Link& link) { return !box.is_free(v + link.step); }))
      beside.set(v);
  });
  return beside;
}

/// Adds to the band the vertices near both labels of a boundary that disagrees: the minimal surface passes there.
/// Increases `reach` until new vertices are found, at last to all vertices. Where only fixed
/// vertices join the two, whose u is 0, those beside them with u = 1 join the band.
void grow(VertexMask& band, const RimVotes& votes, const LevelBox& box, const std::vector<Link>& links, int& reach,
          const Context& context) {
  for (;; reach = twice_the_reach(reach)) {
    context.check();
    const Flood inside = flooded(votes.inside, band, box, links, reach);
    const Flood outside = flooded(votes.outside, band, box, links, reach);
    VertexMask between = inside.reached;
    between &= outside.reached;
    if (between.empty() && inside.all && outside.all) between = beside_fixed(inside.reached, box, links);
    if (between.empty()) continue;
    band |= between;
    return;
  }
}

Level level_of_labels(const VertexMask& inside, const LevelBox& box, const SupportField& support, double lambda,
                      Norm norm, const Context& context) {
  const Vec3i n = box.bricks;
  std::vector<BrickContent> content;
  content.reserve(static_cast<size_t>(n.x) * static_cast<size_t>(n.y) * static_cast<size_t>(n.z));
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        unsigned any = 0, all = 0xFF;
        for_each_brick_row({x, y, z}, [&](int vy, int vz, int) {
          any |= inside.row(x, vy, vz);
          all &= inside.row(x, vy, vz);
        });
        content.push_back(any == 0 ? BrickContent::zero : all == 0xFF ? BrickContent::one : BrickContent::mixed);
      }
  BrickMask band = interface_bricks(content, n);
  add_bricks(support.grid, band);

  Level level = make_level(box, static_cast<float>(lambda), band, support.grid, support.f, context, norm);
  parallel_for(context, level.grid.size(), 64, [&](size_t b) {
    const Vec3i brick = level.grid.coord(b);
    for_each_brick_row(brick, [&](int y, int z, int r) {
      for (int x = 0; x < brick_side; ++x)
        level.u.brick(b)[brick_side * r + x] = inside.row(brick.x, y, z) >> x & 1 ? 1.0f : 0.0f;
    });
  });
  level.inside = GapSides(level.grid, bricks_with_free(box), [&](Vec3i b) {
    const size_t row = static_cast<size_t>(b.z) * static_cast<size_t>(n.y) + static_cast<size_t>(b.y);
    return content[row * static_cast<size_t>(n.x) + static_cast<size_t>(b.x)] == BrickContent::one;
  });
  return level;
}

}  // namespace

std::vector<Link> graph_links(const GraphCutSetup& params, double lambda) {
  if (params.neighbors != 6 && params.neighbors != 26)
    throw ParameterError(fmt::format("neighbors = {}, must be 6 or 26", params.neighbors));
  if (!(lambda > 0)) throw ParameterError(fmt::format("lambda = {:g}, must be > 0", lambda));
  std::vector<Link> links;
  double mean_cost = 0;  // of a unit area: a link's share of it is weight * length * |cos|, whose mean is 1/2
  for (int slot = 0; slot < 27; ++slot) {
    const Vec3i step = slot_offset(slot);
    const int axes = dot(step, step);
    if (axes == 0 || (params.neighbors == 6 && axes > 1)) continue;
    const double length = std::sqrt(axes);
    const bool by_angle = params.weights == LinkWeights::cauchy_crofton && params.neighbors == 26;
    const double weight = (by_angle ? share_of_sphere[axes] : 1.0) / length;
    links.push_back({step, weight});
    mean_cost += 0.5 * weight * length / 2;  // each link is listed both ways
  }
  for (Link& link : links) link.weight *= lambda * mean_area(params.norm) / mean_cost;
  return links;
}

Level solve_graph_cut(const Lattice& lattice, const SupportField& support, double lambda, const GraphCutSetup& params,
                      const Context& context, GraphCutReport& report,
                      const std::function<void(size_t vertices)>& begins) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Link> links = graph_links(params, lambda);
  const LevelBox box = lattice.box(0);
  VertexMask band = vertices_with_data(support, box);
  band.dilate(first_dilation, context);
  band &= free_vertices(box);

  report = {};
  VertexMask inside;
  for (int reach = first_growth;; reach = twice_the_reach(reach)) {
    context.check();
    if (begins) begins(band.count());
    {
      const BandGraph graph(band, box, support, links, context);
      context.progress().detail(fmt::format("graph cut {}: {} vertices", report.growths + 1, graph.vertices()));
      const MinCut cut = min_cut(graph, context);
      report.vertices = graph.vertices();
      report.links = cut.links;
      report.flow = cut.flow;
      report.energy = energy_of(graph, cut);
      report.graph_bytes = std::max(report.graph_bytes, cut.bytes + graph.bytes());
      inside = labels_of(graph, cut, box.bricks);
    }
    OutsideParts parts(band, box, links);
    const RimVotes votes = parts.vote(inside);
    report.globally_optimal = votes.agree;
    if (votes.agree) {
      parts.fill(inside);
      break;
    }
    grow(band, votes, box, links, reach, context);
    ++report.growths;
  }
  Level level = level_of_labels(inside, box, support, lambda, params.norm, context);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return level;
}

}  // namespace soapfilm
