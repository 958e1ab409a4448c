#include "soapfilm/border/walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/some_by_place.h"

namespace soapfilm {

namespace {

constexpr size_t most_directions = 20000, most_candidates = 256;
constexpr float along = 0.9397f;  // cosine of 20 degrees
constexpr float across = 0.9f;    // sine of the angle to the first axis, of candidates for the second
/// Samples in a furnished room reach 1.0, with normals 11 degrees off 0.78, 17 degrees 0.51; bodies without faces at
/// right angles 0.19 (sphere) to 0.34 (an arch).
constexpr double of_a_room = 0.5;

using Axes = std::array<Vec3f, 3>;

/// The sum of the lengths of the directions along one of the axes.
double length_along(const Axes& axes, const std::vector<Vec3f>& directions) {
  double sum = 0;
  for (const Vec3f& d : directions) {
    const float length = norm(d);
    float most = 0;
    for (const Vec3f& axis : axes) most = std::max(most, std::abs(dot(axis, d)));
    if (most > along * length) sum += double{length};
  }
  return sum;
}

/// The candidate with the largest sum, the first of several.
template <class AxesOf>
size_t best_of(const std::vector<Vec3f>& candidates, const std::vector<Vec3f>& directions, const Context& context,
               std::vector<double>& sums, AxesOf&& axes_of) {
  sums.assign(candidates.size(), 0);
  parallel_for(context, candidates.size(), 4,
               [&](size_t k) { sums[k] = length_along(axes_of(candidates[k]), directions); });
  return static_cast<size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
}

}  // namespace

double share_along_axes(std::span<const Vec3d> places, std::span<const Vec3f> directions, const Context& context) {
  Box3d box;
  for (const Vec3d& place : places) box.extend(place);
  std::vector<Vec3f> some;
  for (const uint32_t i :
       some_by_place(box, directions.size(), most_directions, context, [&](size_t k) { return places[k]; }))
    some.push_back(directions[i]);
  double all = 0;
  for (const Vec3f& d : some) all += double{norm(d)};
  if (!(all > 0)) return 0;
  std::vector<Vec3f> candidates(some.begin(),
                                some.begin() + std::min<std::ptrdiff_t>(std::ssize(some), most_candidates));
  for (Vec3f& c : candidates) c = normalized(c);
  std::vector<double> sums;
  const Vec3f first = candidates[best_of(candidates, some, context, sums, [](Vec3f c) { return Axes{c, {}, {}}; })];
  std::vector<Vec3f> second;
  for (const Vec3f& c : candidates)
    if (const Vec3f part = c - first * dot(c, first); norm(part) > across) second.push_back(normalized(part));
  if (second.empty()) return *std::max_element(sums.begin(), sums.end()) / all;
  best_of(second, some, context, sums, [&](Vec3f c) { return Axes{first, c, cross(first, c)}; });
  return *std::max_element(sums.begin(), sums.end()) / all;
}

bool look_along_walls(std::span<const Vec3d> places, std::span<const Vec3f> directions, const Context& context) {
  return share_along_axes(places, directions, context) >= of_a_room;
}

}  // namespace soapfilm
