#include "soapfilm/core/scanner_places.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <tuple>

#include "soapfilm/core/some_by_place.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

/// Keeps the places of the lowest hashes.
class LowestHashes {
 public:
  LowestHashes(size_t most, const Box3d& box) : most_(most), box_(box) {}

  void add(Vec3d place) {
    if (place == last_) return;
    last_ = place;
    kept_.insert({hash_of_place(place, box_), place.x, place.y, place.z});
    if (kept_.size() > most_) kept_.erase(std::prev(kept_.end()));
  }
  std::vector<Vec3d> places() const {
    std::vector<Vec3d> places;
    for (const auto& [hash, x, y, z] : kept_) places.push_back({x, y, z});
    return places;
  }

 private:
  const size_t most_;
  const Box3d box_;
  std::optional<Vec3d> last_;  // neighbors in a scan mostly have the same
  std::set<std::tuple<uint64_t, double, double, double>> kept_;
};

}  // namespace

std::optional<Vec3d> scanner_of(const PointCloud& cloud, size_t i, const std::optional<Vec3d>& sensor) {
  if (!cloud.sensors.empty() && is_finite(cloud.sensors[i])) return cloud.sensors[i];
  const auto scan = std::upper_bound(cloud.scans.begin(), cloud.scans.end(), i,
                                     [](size_t sample, const Scan& s) { return sample < s.end; });
  return scan != cloud.scans.end() && scan->begin <= i && scan->sensor ? scan->sensor : sensor;
}

std::vector<Vec3d> some_scanners(const PointCloud& cloud, const std::optional<Vec3d>& sensor, size_t most) {
  const auto for_each = [&](auto&& visit) {
    const auto visit_known = [&](const std::optional<Vec3d>& place) {
      if (place && is_finite(*place)) visit(*place);
    };
    if (!cloud.sensors.empty())
      for (size_t i = 0; i < cloud.size(); ++i) visit_known(scanner_of(cloud, i, sensor));
    else if (!cloud.scans.empty())
      for (const Scan& scan : cloud.scans) visit_known(scan.sensor ? scan.sensor : sensor);
    else
      visit_known(sensor);
  };
  Box3d box;
  for_each([&](Vec3d place) { box.extend(place); });
  LowestHashes lowest(most, box);
  for_each([&](Vec3d place) { lowest.add(place); });
  return lowest.places();
}

}  // namespace soapfilm
