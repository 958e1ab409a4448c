// Subsamples that are chosen by where samples are, not by their numbers: the same ones however a cloud is ordered, or
// split into files and tiles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/random.h"
#include "soapfilm/vec.h"

namespace soapfilm {

/// Random bits of a place in a box, from its cell among 2^16 along the longest side: they change neither with the unit
/// nor with the origin (but for rounding), nor with the order of the axes.
inline uint64_t hash_of_place(Vec3d place, const Box3d& box) {
  constexpr double cells = 1 << 16;
  const double longest = box.longest(), per_unit = longest > 0 ? cells / longest : 0;
  const auto of = [&](double c, double lo) {
    return Random(static_cast<uint64_t>(static_cast<int64_t>((c - lo) * per_unit))).next();
  };
  return Random(of(place.x, box.lo.x) + of(place.y, box.lo.y) + of(place.z, box.lo.z)).next();
}

/// About `most` of `count` samples, or all of them if these are no more; place(i) is where in `box`, which is that of
/// all, sample i is. Of samples at one place the first counts. In the order of their hashes, which is as good as a
/// random one.
template <class Place>
std::vector<uint32_t> some_by_place(const Box3d& box, size_t count, size_t most, const Context& context,
                                    Place&& place) {
  constexpr size_t samples_per_task = size_t{1} << 15;
  constexpr uint64_t all = ~uint64_t{0};
  const uint64_t limit = count <= most ? all : all / count * most;
  struct Found {
    uint64_t hash;
    uint32_t sample;
  };
  auto found = gather<Found>(count, samples_per_task, context, [&](size_t i, std::vector<Found>& to) {
    if (const uint64_t hash = hash_of_place(place(i), box); hash <= limit)
      to.push_back({hash, static_cast<uint32_t>(i)});
  });
  const auto key = [&](const Found& f) {
    const Vec3d at = place(f.sample);
    return std::make_tuple(at.x, at.y, at.z, f.sample);
  };
  std::sort(found.begin(), found.end(),
            [&](const Found& a, const Found& b) { return a.hash != b.hash ? a.hash < b.hash : key(a) < key(b); });
  std::vector<uint32_t> some;
  some.reserve(found.size());
  for (size_t k = 0; k < found.size(); ++k)
    if (k == 0 || found[k].hash != found[k - 1].hash || !(place(found[k].sample) == place(found[k - 1].sample)))
      some.push_back(found[k].sample);
  return some;
}

}  // namespace soapfilm
