#include "soapfilm/orient/far_planes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/box_of.h"
#include "soapfilm/core/box_tree.h"
#include "soapfilm/core/morton.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/orient/sample_cells.h"
#include "soapfilm/orient/sites.h"

namespace soapfilm {

namespace {

constexpr int coarsest_means = 6;          // depth: a 64th of the box
constexpr size_t nearest_means = 12;       // means of cells
constexpr double spans_plane = 0.15;       // Plane::wide of what is no line
constexpr double most_thick_mean = 0.015;  // Plane::flat
constexpr size_t points_per_task = 512;

/// The means of the points of each cell, by the cells' keys.
struct CellMeans {
  std::vector<uint64_t> keys;
  std::vector<Vec3d> means;
};

CellMeans means_of_cells(std::span<const Vec3d> points, const SampleOrder& order, int depth) {
  const int up = 3 * (SampleOrder::deepest - depth);
  CellMeans found;
  for (size_t k = 0; k < order.size();) {
    const uint64_t key = order.key(k) >> up;
    Vec3d sum;
    size_t count = 0;
    for (; k < order.size() && order.key(k) >> up == key; ++k, ++count) sum += points[order.sample(k)];
    found.keys.push_back(key);
    found.means.push_back(sum / static_cast<double>(count));
  }
  return found;
}

enum class Found : uint8_t { line, plane, neither };

struct Around {
  Found what = Found::line;
  Vec3f normal{};
};

Around look_around(std::span<const Vec3d> means, std::span<const uint32_t> nearest, Vec3d p) {
  if (nearest.size() < nearest_means) return {Found::neither, {}};
  const Plane plane = fit_plane(means, p, nearest);
  if (plane.wide < spans_plane) return {};
  if (plane.flat > most_thick_mean || plane.normal == Vec3d{}) return {Found::neither, {}};
  constexpr double steps = 16384;  // rounding errors after a permutation of the axes must not reach the mesh
  const Vec3d n = plane.normal;
  return {Found::plane,
          normalized(Vec3f(Vec3d{std::round(n.x * steps), std::round(n.y * steps), std::round(n.z * steps)}))};
}

/// The first depth at which cells hold several points each: at finer ones the points themselves show as much.
int finest_depth(const SampleOrder& order) {
  constexpr double share = 0.6;  // of cells to points
  for (int depth = SampleOrder::deepest - 2; depth > coarsest_means; --depth) {
    const int up = 3 * (SampleOrder::deepest - depth);
    size_t cells = 1;
    for (size_t k = 1; k < order.size(); ++k) cells += order.key(k) >> up != order.key(k - 1) >> up;
    if (static_cast<double>(cells) < share * static_cast<double>(order.size())) return depth;
  }
  return coarsest_means;
}

}  // namespace

std::vector<Vec3f> far_planes(std::span<const Vec3d> points, std::span<const uint32_t> wanted, const Context& context) {
  std::vector<Vec3f> normals(wanted.size());
  const Box3d box = box_of(points);
  if (wanted.empty() || !(box.longest() > 0)) return normals;
  const SampleOrder order(points, {}, box, context);
  std::vector<Found> state(wanted.size(), Found::line);
  for (int depth = finest_depth(order); depth >= coarsest_means; --depth) {
    const CellMeans cells = means_of_cells(points, order, depth);
    const BoxTree tree(cells.means, context);
    parallel_chunks(context, wanted.size(), points_per_task, [&](size_t begin, size_t end) {
      context.check();
      NearestPoints nearest(nearest_means, [](uint32_t a, uint32_t b) { return a < b; });
      for (size_t k = begin; k < end; ++k) {
        if (state[k] != Found::line) continue;
        const Vec3d p = points[wanted[k]];
        const uint64_t key = morton_key((p - box.lo) / box.longest(), depth);
        const auto cell = std::lower_bound(cells.keys.begin(), cells.keys.end(), key);
        nearest.restart();
        tree.search(p, static_cast<size_t>(cell - cells.keys.begin()), nearest);
        const Around around = look_around(cells.means, nearest.found(), p);
        state[k] = around.what;
        normals[k] = around.normal;
      }
    });
  }
  return normals;
}

}  // namespace soapfilm
