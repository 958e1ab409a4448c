#include "soapfilm/components/scanners.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "soapfilm/core/scanner_places.h"

namespace soapfilm {

namespace {

constexpr size_t most_scanners = 64;

class Air {
 public:
  Air(const Labels& labels, bool complement) : labels_(labels), complement_(complement) {}

  bool in_box(Vec3i v) const { return labels_.box.is_free(v); }
  bool at(Vec3i v) const {
    if (!in_box(v)) return !complement_;
    return labels_.test(v) == complement_;
  }
  bool open_along(Vec3i v, int axis, int step) const {
    for (; in_box(v); v[axis] += step)
      if (!at(v)) return false;
    return true;
  }

 private:
  const Labels& labels_;
  bool complement_;
};

}  // namespace

std::vector<Vec3d> scanner_positions(const PointCloud& cloud, const std::optional<Vec3d>& sensor) {
  std::vector<Vec3d> positions = some_scanners(cloud, sensor, most_scanners);
  const auto order = [](const Vec3d& p) { return std::tie(p.x, p.y, p.z); };
  std::sort(positions.begin(), positions.end(), [&](const Vec3d& a, const Vec3d& b) { return order(a) < order(b); });
  return positions;
}

ScannerReport place_scanners(const Labels& labels, bool complement, const std::vector<Vec3d>& positions) {
  const Air air(labels, complement);
  ScannerReport report;
  constexpr double far = 1e9;  // vertices
  const auto nearest = [&](double x) { return static_cast<int32_t>(std::round(std::clamp(x, -far, far))); };
  for (const Vec3d& p : positions) {
    const Vec3i v{nearest(p.x), nearest(p.y), nearest(p.z)};
    ++report.scanners;
    if (!air.at(v)) {
      ++report.in_solid;
      continue;
    }
    bool enclosed = true;
    for (int axis = 0; axis < 3 && enclosed; ++axis)
      enclosed = !air.open_along(v, axis, 1) && !air.open_along(v, axis, -1);
    report.enclosed += enclosed;
  }
  return report;
}

}  // namespace soapfilm
