#include "soapfilm/finish/islands.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/error.h"
#include "soapfilm/finish/parts.h"

namespace soapfilm {

namespace {

/// Area of a plane per voxel face that its staircase has, averaged over its directions.
constexpr double area_per_face = 2.0 / 3;
/// How far before and behind a sample its sides are looked up, voxels: first where accurate samples tell, then beyond
/// the noise. A viewing direction may be oblique to the surface and reach less deep.
constexpr float reaches[] = {1, 2};

Vec3i nearest_vertex(Vec3f p) {
  return {static_cast<int>(std::floor(p.x + 0.5f)), static_cast<int>(std::floor(p.y + 0.5f)),
          static_cast<int>(std::floor(p.z + 0.5f))};
}

/// The part whose surface the sample lies on and looks out of; 0 when there is none.
uint32_t supported_part(const Parts& parts, Vec3i first_vertex, Vec3f local, Vec3f direction) {
  const Vec3f outward = normalized(direction);
  for (const float reach : reaches) {
    const uint32_t inner = parts.at(first_vertex + nearest_vertex(local - outward * reach));
    const uint32_t outer = parts.at(first_vertex + nearest_vertex(local + outward * reach));
    if (!parts[inner].inside || parts[outer].inside) continue;
    if (parts[inner].around == outer) return inner;
    if (parts[outer].around == inner) return outer;
  }
  return 0;
}

/// Samples on the surface of each part.
std::vector<size_t> count_samples(const Parts& parts, const GridSamples& samples, const Parallel& parallel) {
  std::vector<uint32_t> part(samples.size());
  parallel.for_each(samples.bricks.size(), 16, [&](size_t b) {
    const Vec3i first_vertex = samples.bricks.first_vertex(b);
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      part[s] = supported_part(parts, first_vertex, samples.local[s], samples.direction[s]);
  });
  std::vector<size_t> count(parts.size());
  for (const uint32_t p : part) ++count[p];
  return count;
}

/// Which side each part ends on: its own, or where it is dropped that of the part around it.
std::vector<uint8_t> final_sides(const Parts& parts, const std::vector<uint8_t>& keep) {
  constexpr uint8_t unknown = 2;
  std::vector<uint8_t> side(parts.size(), unknown);
  side[0] = 0;
  for (uint32_t part = 1; part < parts.size(); ++part) {
    std::vector<uint32_t> path;
    uint32_t p = part;
    for (; side[p] == unknown && !keep[p]; p = parts[p].around) path.push_back(p);
    if (side[p] == unknown) side[p] = parts[p].inside;
    for (const uint32_t dropped : path) side[dropped] = side[p];
  }
  return side;
}

}  // namespace

void validate(const IslandParams& params) {
  const auto require = [](const char* name, double value) {
    if (!(value >= 0)) throw ParameterError(fmt::format("{} = {:g}, must be >= 0", name, value));
  };
  require("min_support", params.min_support);
  require("few_samples", params.few_samples);
  require("many_samples", params.many_samples);
}

void drop_islands(Level& level, float threshold, const GridSamples& samples, double density, const IslandParams& params,
                  const Parallel& parallel, IslandReport& report) {
  const Parts parts(level, threshold, parallel);
  const std::vector<size_t> count = count_samples(parts, samples, parallel);
  uint32_t best = 0;
  for (uint32_t p = 1; p < parts.size(); ++p)
    if (parts[p].inside && (best == 0 || count[p] > count[best])) best = p;

  std::vector<uint8_t> keep(parts.size(), 1);
  bool first_kept = true;
  for (uint32_t p = 1; p < parts.size(); ++p) {
    const double area = area_per_face * static_cast<double>(parts[p].faces);
    const double support = static_cast<double>(count[p]) / (density * area);
    const auto at_least = [&](int limit) { return count[p] >= static_cast<size_t>(limit); };
    keep[p] =
        p == best || (at_least(params.few_samples) && (at_least(params.many_samples) || support >= params.min_support));
    IslandCount& counted = parts[p].inside ? report.objects : report.voids;
    ++(keep[p] ? counted.kept : counted.dropped);
    if (keep[p]) {
      report.lowest_kept = first_kept ? support : std::min(report.lowest_kept, support);
      first_kept = false;
    } else {
      report.highest_dropped = std::max(report.highest_dropped, support);
      report.samples += count[p];
      report.area += area;
    }
  }
  if (report.objects.dropped + report.voids.dropped == 0) return;
  const std::vector<uint8_t> side = final_sides(parts, keep);
  for (uint32_t p = 1; p < parts.size(); ++p)
    if (side[p] != parts[p].inside) report.vertices += parts[p].vertices;
  parts.write(side, level, parallel);
}

}  // namespace soapfilm
