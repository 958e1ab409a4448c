#include "soapfilm/orient/outer_sides.h"

#include <cmath>
#include <limits>

namespace soapfilm {

namespace {

/// Length of the mean normal: 0 for a closed surface, 0.2 for a cube without a face, 0.5 for a half sphere, 1 for a
/// plane.
constexpr double least_of_sheet = 0.35;
/// Cosine of the mean normal and up, below which a sheet stands upright.
constexpr double upright = 0.25;
/// Sum of votes over that of their sizes, below which they contradict each other.
constexpr double close_votes = 0.3;

struct Part {
  double count = 0, flat = 0;  ///< points
  Vec3d normals;               ///< sum over flat points; over all where almost none is flat
  Vec3d all_normals;
  double vote = 0, votes = 0;  ///< sums over directions: of votes, and of their sizes
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
    if (!is_flat(plane)) continue;
    ++part.flat;
    part.normals += plane.normal;
  }
  return found;
}

/// The farthest point along a direction looks in it.
void vote_by_extremes(const SignedParts& parts, std::vector<Part>& found) {
  struct Furthest {
    double reach = -std::numeric_limits<double>::infinity();
    bool flat = false;
    double vote = 0;
  };
  for (int code = 0; code < 27; ++code) {
    const Vec3d towards = normalized(static_cast<Vec3d>(Vec3i{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1}));
    std::vector<Furthest> furthest(parts.count);
    for (size_t i = 0; i < parts.part.size(); ++i) {
      if (parts.part[i] >= parts.count) continue;
      Furthest& best = furthest[parts.part[i]];
      const Plane& plane = parts.scene.planes[i];
      const double reach = dot(parts.scene.points[i], towards);
      const bool flat = is_flat(plane) || mostly_rough(found[parts.part[i]]);
      if (flat > best.flat || (flat == best.flat && reach > best.reach)) best = {reach, flat, dot(plane.normal, towards)};
    }
    for (size_t c = 0; c < parts.count; ++c) {
      found[c].vote += furthest[c].vote;
      found[c].votes += std::abs(furthest[c].vote);
    }
  }
}

}  // namespace

OuterSides find_outer_sides(const SignedParts& parts, std::optional<Vec3d> up) {
  std::vector<Part> found = count(parts);
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
      if (sheet || std::abs(part.vote) < close_votes * part.votes) sides.doubtful += points;
    }
  }
  return sides;
}

}  // namespace soapfilm
