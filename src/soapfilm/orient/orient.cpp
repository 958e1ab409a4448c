#include "soapfilm/orient/orient.h"
namespace soapfilm {
std::vector<Vec3f> orient(const PointCloud& c, const OrientParams&, const Parallel&, Progress&, OrientReport& r) {
  std::vector<Vec3f> d(c.size());
  if (!c.normals.empty()) {
    for (size_t i = 0; i < c.size(); ++i) d[i] = normalized(c.normals[i]);
    r.from_normals = c.size();
    return d;
  }
  for (const Scan& s : c.scans)
    for (size_t i = s.begin; i < s.end; ++i) {
      if (s.sensor)
        d[i] = Vec3f(normalized(*s.sensor - c.positions[i]));
      else if (s.view_direction)
        d[i] = Vec3f(*s.view_direction);
    }
  r.from_scan = c.size();
  return d;
}
}  // namespace soapfilm
