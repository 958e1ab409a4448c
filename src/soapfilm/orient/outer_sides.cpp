#include "soapfilm/orient/outer_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace soapfilm {

namespace {

/// Length of the mean normal: 0 for a closed surface, 0.2 for a cube without a face, 0.5 for a half sphere, 1 for a
/// plane.
constexpr double least_of_sheet = 0.35;
/// Cosine of the mean normal and up, below which a sheet stands upright.
constexpr double upright = 0.25;
/// Sum of votes over that of their sizes, below which they contradict each other: of extreme points, and of all.
constexpr double close_votes = 0.3, close_flux = 0.1;

struct Part {
  double count = 0, flat = 0;  ///< points
  Vec3d normals;               ///< sum over flat points; over all where almost none is flat
  Vec3d all_normals;
  Vec3d middle;                ///< of the points
  double vote = 0, votes = 0;  ///< sums: of votes, and of their sizes
};

bool mostly_rough(const Part& part) {
  constexpr double almost_none = 0.1;
  return part.flat < almost_none * part.count;
}

std::vector<Part> count(const SignedParts& parts) {
  std::vector<Part> found(parts.count);
  for (size_t i = 0; i < parts.part.size(); ++i) {
    if (parts.part[i] >= parts.count) continue;
    Part& part = found[parts.part[i]];
    const Plane& plane = parts.scene.planes[i];
    ++part.count;
    part.all_normals += plane.normal;
    part.middle += parts.scene.points[i];
    if (!is_flat(plane)) continue;
    ++part.flat;
    part.normals += plane.normal;
  }
  for (Part& part : found)
    if (part.count > 0) part.middle = part.middle / part.count;
  return found;
}

/// Among noise the farthest points are outliers. The flux of x through a closed surface is three times its volume, to
/// which each point contributes alike: outliers look to any side.
void vote_by_flux(const SignedParts& parts, std::vector<Part>& found) {
  for (size_t i = 0; i < parts.part.size(); ++i) {
    if (parts.part[i] >= parts.count || !mostly_rough(found[parts.part[i]])) continue;
    Part& part = found[parts.part[i]];
    const double flux = dot(parts.scene.planes[i].normal, parts.scene.points[i] - part.middle);
    part.vote += flux;
    part.votes += std::abs(flux);
  }
}

/// The farthest flat point along a direction looks in it. Several directions at a time, since points may be on disk.
void vote_by_extremes(const SignedParts& parts, std::vector<Part>& found) {
  constexpr size_t directions = 27, most_at_once = size_t{1} << 20;
  struct Furthest {
    double reach = -std::numeric_limits<double>::infinity();
    double vote = 0;
  };
  const size_t at_once = std::clamp<size_t>(most_at_once / std::max<size_t>(parts.count, 1), 1, directions);
  for (size_t first = 0; first < directions; first += at_once) {
    const size_t count = std::min(at_once, directions - first);
    std::array<Vec3d, directions> towards{};
    for (size_t k = 0; k < count; ++k) {
      const auto code = static_cast<int>(first + k);
      towards[k] = normalized(static_cast<Vec3d>(Vec3i{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1}));
    }
    std::vector<Furthest> furthest(parts.count * count);
    for (size_t i = 0; i < parts.part.size(); ++i) {
      const Plane& plane = parts.scene.planes[i];
      if (parts.part[i] >= parts.count || !is_flat(plane) || mostly_rough(found[parts.part[i]])) continue;
      Furthest* const best = furthest.data() + parts.part[i] * count;
      for (size_t k = 0; k < count; ++k)
        if (const double reach = dot(parts.scene.points[i], towards[k]); reach > best[k].reach)
          best[k] = {reach, dot(plane.normal, towards[k])};
    }
    for (size_t c = 0; c < parts.count; ++c)
      for (size_t k = 0; k < count; ++k) {
        found[c].vote += furthest[c * count + k].vote;
        found[c].votes += std::abs(furthest[c * count + k].vote);
      }
  }
}

}  // namespace

OuterSides find_outer_sides(const SignedParts& parts, std::optional<Vec3d> up) {
  std::vector<Part> found = count(parts);
  vote_by_flux(parts, found);
  vote_by_extremes(parts, found);
  OuterSides sides;
  for (const Part& part : found) {
    const bool rough = mostly_rough(part);
    const Vec3d normals = rough ? part.all_normals : part.normals;
    const double length = norm(normals);
    const bool sheet = length > least_of_sheet * (rough ? part.count : part.flat);
    const double towards_up = up && length > 0 ? dot(normals, *up) / length : 0;
    const auto points = static_cast<size_t>(part.count);
    sides.is_sheet.push_back(sheet);
    if (sheet && std::abs(towards_up) >= upright) {
      sides.votes.push_back(towards_up);
      sides.sheets_up += points;
    } else {
      sides.votes.push_back(part.vote);
      if (sheet || std::abs(part.vote) < (rough ? close_flux : close_votes) * part.votes) sides.doubtful += points;
    }
  }
  return sides;
}

}  // namespace soapfilm
