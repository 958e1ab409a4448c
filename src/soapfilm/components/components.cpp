#include "soapfilm/components/components.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/components/parts.h"
#include "soapfilm/core/share.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

constexpr size_t bricks_per_task = 16;

/// Distances before and behind a sample at which its two sides are looked up, voxels: one for accurate samples, one
/// beyond noise. A viewing direction may be oblique to the surface and reach less deep.
constexpr std::array<float, 2> reaches{1, 2};
/// The parts whose surface a sample lies on, one for each reach; 0 where there is none.
using Supported = std::array<uint32_t, reaches.size()>;

/// Like std::floor, which is a function call if the target may lack a rounding instruction.
int floor_of(float x) {
  const int towards_zero = static_cast<int>(x);
  return towards_zero - (static_cast<float>(towards_zero) > x);
}

Vec3i nearest_vertex(Vec3f p) { return {floor_of(p.x + 0.5f), floor_of(p.y + 0.5f), floor_of(p.z + 0.5f)}; }

/// `local` is relative to the brick's first vertex.
Supported supported_parts(const Parts& parts, const PartsAround& around, Vec3f local, Vec3f outward) {
  Supported supported{};
  for (size_t k = 0; k < reaches.size(); ++k) {
    const uint32_t inner = around.at(nearest_vertex(local - outward * reaches[k]));
    const uint32_t outer = around.at(nearest_vertex(local + outward * reaches[k]));
    if (!parts[inner].inside || parts[outer].inside) continue;
    if (parts[inner].around == outer)
      supported[k] = inner;
    else if (parts[outer].around == inner)
      supported[k] = outer;
  }
  return supported;
}

/// Number of samples on the surface of each part, and the sum of their weights.
struct Evidence {
  std::vector<double> count;  ///< each by its weight in the cloud
  std::vector<double> weight;
};

/// The same for some samples, for the few parts that these lie on.
struct PartEvidence {
  uint32_t part;
  double count;
  double weight;
};

/// To that of the same brick, which begins at `first`.
void add_evidence(uint32_t part, double count, double weight, size_t first, std::vector<PartEvidence>& evidence) {
  auto at = std::find_if(evidence.begin() + static_cast<std::ptrdiff_t>(first), evidence.end(),
                         [&](const PartEvidence& e) { return e.part == part; });
  if (at == evidence.end()) at = evidence.insert(at, {part, 0, 0});
  at->count += count;
  at->weight += weight;
}

/// A sample that may lie on two surfaces counts for both, so that removing one of the parts leaves the support of the
/// other unchanged.
Evidence evidence_of(const Parts& parts, const GridSamples& samples, const Context& context) {
  const auto of_bricks = [&](size_t b, std::vector<PartEvidence>& found) {
    const PartsAround around(parts, samples.bricks.coord(b));
    const size_t first = found.size();
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Vec3f direction = samples.direction[s];
      const Supported by = supported_parts(parts, around, samples.local[s], normalized(direction));
      const double weight = norm(direction);
      for (size_t k = 0; k < by.size(); ++k)
        if (k == 0 || by[k] != by[0]) add_evidence(by[k], samples.weight_of(s), weight, first, found);
    }
  };
  Evidence evidence{std::vector<double>(parts.size()), std::vector<double>(parts.size())};
  for (const PartEvidence& e : share_gather<PartEvidence>(samples.bricks.size(), bricks_per_task, context, of_bricks)) {
    evidence.count[e.part] += e.count;
    evidence.weight[e.part] += e.weight;
  }
  return evidence;
}

/// Inside parts that reach the border of the box: where the surface may end there, that is not their end.
std::vector<uint8_t> at_border_of(const Labels& labels, const Parts& parts) {
  std::vector<uint8_t> found(parts.size());
  for (size_t b = 0; b < labels.grid.size(); ++b) {
    const Vec3i brick = labels.grid.coord(b);
    if (!at_border(labels.box, brick)) continue;
    const PartsAround around(parts, brick);
    const FreeRange free = free_range(labels.box, brick);
    for (int z = free.lo.z; z < free.hi.z; ++z)
      for (int y = free.lo.y; y < free.hi.y; ++y)
        for (int x = free.lo.x; x < free.hi.x; ++x) {
          const Vec3i v = labels.grid.first_vertex(b) + Vec3i{x, y, z};
          bool outermost = false;
          for (int axis = 0; axis < 3; ++axis)
            outermost = outermost || v[axis] == labels.box.free_lo[axis] || v[axis] == labels.box.free_hi[axis];
          if (outermost && labels.bits[b].test(x, y, z)) found[around.at({x, y, z})] = 1;
        }
  }
  return found;
}

/// Which parts stay. If no component would, the one with most samples does.
std::vector<uint8_t> parts_to_keep(const Parts& parts, const std::vector<double>& count,
                                   const std::vector<double>& support, const ComponentParams& params) {
  const double few = params.few_samples, many = params.many_samples;
  std::vector<uint8_t> keep(parts.size(), 1);
  bool an_object = false;
  uint32_t best = 0;
  for (uint32_t p = 1; p < parts.size(); ++p) {
    const double least = count[p] >= many ? std::min(params.sparse_support, params.min_support) : params.min_support;
    keep[p] = count[p] >= few && support[p] >= least;
    if (!parts[p].inside) continue;
    an_object = an_object || keep[p];
    if (best == 0 || count[p] > count[best]) best = p;
  }
  if (!an_object) keep[best] = 1;
  return keep;
}

/// The final side of each part: its own, or where it is dropped that of the part around it.
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

void validate(const ComponentParams& params) {
  const auto require = [](const char* name, double value) {
    if (!(value >= 0)) throw ParameterError(fmt::format("{} = {:g}, must be >= 0", name, value));
  };
  require("min_support", params.min_support);
  require("sparse_support", params.sparse_support);
  require("few_samples", params.few_samples);
  require("many_samples", params.many_samples);
}

void drop_components(Labels& labels, const GridSamples& samples, double density, const ComponentSetup& params,
                     const Context& context, ComponentReport& report) {
  const Parts parts(labels, context);
  const auto [count, weight] = evidence_of(parts, samples, context);
  std::vector<double> area(parts.size()), support(parts.size());
  for (uint32_t p = 1; p < parts.size(); ++p) {
    area[p] = area_per_face * static_cast<double>(parts[p].faces);
    support[p] = weight[p] / (density * area[p]);
  }
  std::vector<uint8_t> keep = parts_to_keep(parts, count, support, params);
  if (params.open) {
    const std::vector<uint8_t> at_border = at_border_of(labels, parts);
    for (uint32_t p = 1; p < parts.size(); ++p) keep[p] |= at_border[p];
  }
  bool first_kept = true;
  for (uint32_t p = 1; p < parts.size(); ++p) {
    ComponentReport::Count& counted = parts[p].inside ? report.objects : report.cavities;
    ++(keep[p] ? counted.kept : counted.dropped);
    if (keep[p]) {
      report.lowest_kept = first_kept ? support[p] : std::min(report.lowest_kept, support[p]);
      first_kept = false;
    } else {
      report.highest_dropped = std::max(report.highest_dropped, support[p]);
      report.samples += static_cast<size_t>(std::lround(count[p]));
      report.area += area[p];
    }
  }
  if (report.objects.dropped + report.cavities.dropped == 0) return;
  const std::vector<uint8_t> side = final_sides(parts, keep);
  for (uint32_t p = 1; p < parts.size(); ++p)
    if (side[p] != parts[p].inside) report.vertices += parts[p].vertices;
  parts.write(side, labels, context);
}

}  // namespace soapfilm
