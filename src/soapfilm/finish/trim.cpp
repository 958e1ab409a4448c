#include "soapfilm/finish/trim.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/error.h"
#include "soapfilm/extract/cut.h"
#include "soapfilm/finish/hole_list.h"
#include "soapfilm/finish/measure_result.h"
#include "soapfilm/finish/shells.h"
#include "soapfilm/finish/trim_levels.h"
#include "soapfilm/finish/trim_regions.h"

namespace soapfilm {

namespace {

constexpr double nearest_cut = 0.2;     // share of an edge, from its ends: no slivers at a cut
constexpr double small_piece_area = 5;  // times distance^2: a little more than the disk around a single sample
constexpr uint32_t few_samples = 6;     // that a piece faces: with so many, it is a small part and not an outlier

double area_of(const Mesh& mesh, const Triangle& t) {
  const Vec3d a = mesh.vertices[t[0]];
  return 0.5 * norm(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
}

/// The area that lies beyond the cut.
double area_beyond(const Mesh& mesh, const TrimLevels& levels) {
  double beyond = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto corners = std::count_if(t.begin(), t.end(), [&](uint32_t v) { return levels.level[v] > 1; });
    beyond += area_of(mesh, t) * static_cast<double>(corners) / 3;
  }
  return beyond;
}

/// Vertices that the cut would take, or takes.
std::vector<uint8_t> beyond(const TrimLevels& levels) {
  std::vector<uint8_t> is_beyond;
  for (const double level : levels.level) is_beyond.push_back(level > 1);
  return is_beyond;
}

/// Cuts a mesh along the line where its vertices' levels pass 1 (TrimLevels).
class Cut {
 public:
  Cut(Mesh& mesh, TrimLevels levels, double distance)
      : mesh_(mesh), distance_(distance), level_(std::move(levels.level)), nearest_(std::move(levels.nearest)) {}

  /// Far vertices close to the cut are moved onto it, and stay. (Near ones move the cut a little: cut_point().)
  void snap_cuts() {
    on_cut_.assign(level_.size(), 0);
    for (const Triangle& t : mesh_.triangles)
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = t[k], b = t[(k + 1) % 3];
        if (far(a) == far(b)) continue;
        const uint32_t near_end = far(a) ? b : a, far_end = far(a) ? a : b;
        if (share_of_cut(near_end, far_end) > 1 - nearest_cut) on_cut_[far_end] = 1;
      }
    for (size_t v = 0; v < level_.size(); ++v)
      if (on_cut_[v]) level_[v] = 1;
  }

  /// Keeps the triangles on the near side of the cut, and clips those that it crosses.
  void clip() {
    std::vector<Triangle> kept;
    kept.reserve(mesh_.triangles.size());
    at_cut_.assign(mesh_.vertices.size(), 0);
    for (const Triangle& t : mesh_.triangles) {
      if (!far(t[0]) && !far(t[1]) && !far(t[2])) {
        kept.push_back(t);
        continue;
      }
      std::array<uint32_t, 4> polygon{};
      size_t corners = 0;
      bool inside = false;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = t[k], b = t[(k + 1) % 3];
        if (!far(a)) {
          at_cut_[a] = 1;
          polygon[corners++] = a;
          inside = inside || !on_cut_[a];
        }
        if (crosses(a, b)) polygon[corners++] = cut_point(a, b);
      }
      if (!inside || corners < 3) continue;
      if (corners == 3) {
        kept.push_back({polygon[0], polygon[1], polygon[2]});
        continue;
      }
      const auto length = [&](size_t i, size_t j) {
        return norm(mesh_.vertices[polygon[i]] - mesh_.vertices[polygon[j]]);
      };
      const size_t first = length(0, 2) <= length(1, 3) ? 0 : 1;
      const auto corner = [&](size_t i) { return polygon[(i + first) % 4]; };
      kept.push_back({corner(0), corner(1), corner(2)});
      kept.push_back({corner(0), corner(2), corner(3)});
    }
    mesh_.triangles = std::move(kept);
  }

  /// Removes small pieces that a cut has touched.
  size_t drop_small_pieces() {
    const size_t count = mesh_.vertices.size();
    DisjointSets pieces(count);
    for (const Triangle& t : mesh_.triangles) {
      pieces.join(t[0], t[1]);
      pieces.join(t[0], t[2]);
    }
    std::vector<double> area(count);
    std::vector<uint8_t> touched(count);
    for (const Triangle& t : mesh_.triangles) {
      const uint32_t root = pieces.root(t[0]);
      area[root] += area_of(mesh_, t);
      for (const uint32_t v : t) touched[root] |= at_cut_[v];
    }
    const std::vector<uint32_t> samples = samples_of(pieces);
    std::vector<uint8_t> drop(count);
    size_t dropped = 0;
    for (uint32_t v = 0; v < count; ++v) {
      drop[v] = touched[v] && area[v] < small_piece_area * distance_ * distance_ && samples[v] < few_samples;
      dropped += drop[v];
    }
    // If nothing else would be left, the pieces stay.
    const bool all = std::all_of(mesh_.triangles.begin(), mesh_.triangles.end(),
                                 [&](const Triangle& t) { return drop[pieces.root(t[0])] != 0; });
    if (all) drop.assign(count, 0);
    keep_triangles(mesh_, [&](uint32_t v) { return !drop[pieces.root(v)]; });
    return all ? 0 : dropped;
  }

 private:
  /// At the root of each piece: how many samples are the nearest one of some of its vertices; 0 where that is unknown.
  std::vector<uint32_t> samples_of(DisjointSets& pieces) const {
    std::vector<std::pair<uint32_t, uint32_t>> pairs;
    for (uint32_t v = 0; v < nearest_.size(); ++v)
      if (nearest_[v] != TrimLevels::none && !far(v)) pairs.emplace_back(pieces.root(v), nearest_[v]);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::vector<uint32_t> samples(pieces.size());
    for (const auto& [root, sample] : pairs) ++samples[root];
    return samples;
  }

  bool far(uint32_t v) const { return level_[v] > 1; }
  bool crosses(uint32_t a, uint32_t b) const { return far(a) != far(b) && !on_cut_[a] && !on_cut_[b]; }
  double share_of_cut(uint32_t near_end, uint32_t far_end) const {
    return std::max((1 - level_[near_end]) / (level_[far_end] - level_[near_end]), nearest_cut);
  }

  uint32_t cut_point(uint32_t a, uint32_t b) {
    if (far(a)) std::swap(a, b);
    const uint64_t edge = uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    const auto [at, is_new] = points_.try_emplace(edge, static_cast<uint32_t>(mesh_.vertices.size()));
    if (is_new) {
      const Vec3d from = mesh_.vertices[a], to = mesh_.vertices[b];
      mesh_.vertices.push_back(from + (to - from) * share_of_cut(a, b));
      at_cut_.push_back(1);
    }
    return at->second;
  }

  Mesh& mesh_;
  double distance_;
  std::vector<double> level_;
  std::vector<uint32_t> nearest_;                  // TrimLevels::nearest
  std::vector<uint8_t> on_cut_;                    // snapped to it
  std::vector<uint8_t> at_cut_;                    // all vertices of triangles that it crosses
  std::unordered_map<uint64_t, uint32_t> points_;  // by edge
};

}  // namespace

void validate(const TrimParams& params) {
  if (params.distance && !(*params.distance > 0))
    throw ParameterError(fmt::format("trim = {:g}, must be > 0", *params.distance));
  if (params.on && !*params.on && params.distance)
    throw ParameterError(fmt::format("trim = {:g}: trimming is off", *params.distance));
  if (params.on && !*params.on && params.holes) throw ParameterError("trim_holes: trimming is off");
  if (!params.fill_holes) return;
  const double widest = *params.fill_holes;
  if (!(widest > 0)) throw ParameterError(fmt::format("fill_holes = {:g}, must be > 0", widest));
  if (params.on && !*params.on) throw ParameterError(fmt::format("fill_holes = {:g}: trimming is off", widest));
  if (params.holes) throw ParameterError(fmt::format("fill_holes = {:g}: trim_holes leaves none filled", widest));
}

void trim(Mesh& mesh, const GridSamples& samples, const Lattice& lattice, const TrimSetup& params,
          const Context& context, TrimReport& report) {
  report.distance = params.distance.value_or(unseen_distance(params.density, lattice));
  TrimLevels levels = find_trim_levels(mesh, samples, lattice, report.distance, params.ends, context);
  report.nothing_near = std::all_of(levels.level.begin(), levels.level.end(), [](double level) { return level > 1; });
  context.progress().advance(0.6, "distances");
  if (report.nothing_near) return;
  const double before = mesh.area();
  const std::vector<uint8_t> unseen = beyond(levels);
  if (area_beyond(mesh, levels) < params.least_beyond * before) {
    report.holes = list_holes(mesh, unseen, {});
    return;
  }
  const std::vector<uint32_t> crossings =
      params.ends ? count_crossings(mesh, levels.level, params.rays, lattice, context) : std::vector<uint32_t>();
  const bool cuts = choose_regions(
      mesh, levels, crossings, {params.ends, params.holes, report.distance, lattice.voxel, params.fill_holes}, report);
  report.holes = list_holes(mesh, unseen, beyond(levels));
  if (cuts) {
    Cut cut(mesh, std::move(levels), report.distance);
    cut.snap_cuts();
    cut.clip();
    report.leftovers = cut.drop_small_pieces();
  }
  if (params.ends) report.shells = drop_shells(mesh);
  report.removed_area = std::max(0.0, 1 - mesh.area() / before);
}

}  // namespace soapfilm
