#include "soapfilm/finish/self_check.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/random.h"
#include "soapfilm/evaluate/sample_mesh.h"
#include "soapfilm/finish/nearest_sample.h"

namespace soapfilm {

namespace {

constexpr size_t most_picked = 20000;
constexpr uint64_t seed = 20000;

/// Lattice coordinates of samples picked by lot: one of each stretch of them.
std::vector<Vec3d> picked_samples(const GridSamples& samples) {
  const size_t stretch = (samples.size() + most_picked - 1) / most_picked;
  std::vector<Vec3d> picked;
  size_t brick = 0;
  for (size_t k = 0; k * stretch < samples.size(); ++k) {
    const size_t s = one_of_stretch(k, stretch, samples.size());
    while (samples.begin[brick + 1] <= s) ++brick;
    picked.push_back(Vec3d(samples.bricks.first_vertex(brick)) + Vec3d(samples.local[s]));
  }
  return picked;
}

/// Square of the distance of p to the triangle (Ericson 2005, Real-Time Collision Detection, section 5.1.5).
double distance2(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const auto to = [&](Vec3d q) { return dot(p - q, p - q); };
  const Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return to(a);
  if (d3 >= 0 && d4 <= d3) return to(b);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + ab * (d1 / (d1 - d3)));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + ac * (d2 / (d2 - d6)));
  if (va <= 0 && d4 >= d3 && d5 >= d6) return to(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double sum = va + vb + vc;
  return to(a + ab * (vb / sum) + ac * (vc / sum));
}

/// Places by the cubes of 8 voxels that they have within their reach: what is near a triangle is in the lists of the
/// cubes that the triangle meets.
class Reached {
 public:
  explicit Reached(const std::vector<Vec3d>& places) : places_(places), found_(places.size()) {
    const Vec3d reach{self_check_reach, self_check_reach, self_check_reach};
    for (uint32_t i = 0; i < places.size(); ++i)
      for_each_cube(places[i] - reach, places[i] + reach, [&](uint64_t cube) { in_cube_[cube].push_back(i); });
  }

  void find_near(Vec3d a, Vec3d b, Vec3d c) {
    const auto least = [&](int axis) { return std::min({a[axis], b[axis], c[axis]}); };
    const auto most = [&](int axis) { return std::max({a[axis], b[axis], c[axis]}); };
    const Vec3d lo{least(0), least(1), least(2)}, hi{most(0), most(1), most(2)};
    for_each_cube(lo, hi, [&](uint64_t cube) {
      const auto list = in_cube_.find(cube);
      if (list == in_cube_.end()) return;
      for (const uint32_t i : list->second) {
        if (found_[i].load(std::memory_order_relaxed)) continue;
        const Vec3d p = places_[i];
        bool beyond = false;
        for (int axis = 0; axis < 3; ++axis)
          beyond = beyond || p[axis] < lo[axis] - self_check_reach || p[axis] > hi[axis] + self_check_reach;
        if (!beyond && distance2(p, a, b, c) <= self_check_reach * self_check_reach)
          found_[i].store(1, std::memory_order_relaxed);
      }
    });
  }

  size_t missed() const {
    return static_cast<size_t>(std::count_if(found_.begin(), found_.end(), [](const auto& f) { return !f.load(); }));
  }

 private:
  template <class Visit>
  static void for_each_cube(Vec3d lo, Vec3d hi, Visit&& visit) {
    const auto index = [](double x) { return static_cast<int64_t>(std::floor(x / brick_side)); };
    for (int64_t z = index(lo.z); z <= index(hi.z); ++z)
      for (int64_t y = index(lo.y); y <= index(hi.y); ++y)
        for (int64_t x = index(lo.x); x <= index(hi.x); ++x) {
          // 21 bits for each: more than the lattice has; two cubes of one name would only cost time.
          const auto bits = [](int64_t i) { return static_cast<uint64_t>(i) & 0x1FFFFF; };
          visit(bits(x) | bits(y) << 21 | bits(z) << 42);
        }
  }

  const std::vector<Vec3d>& places_;
  std::vector<std::atomic<uint8_t>> found_;  // only ever set: the order of threads does not matter
  std::unordered_map<uint64_t, std::vector<uint32_t>> in_cube_;
};

double lost_share(const Mesh& mesh, const std::vector<Vec3d>& picked, const Lattice& lattice,
                  const Parallel& parallel) {
  Reached reached(picked);
  parallel.for_each(mesh.triangles.size(), 4096, [&](size_t i) {
    const Triangle& t = mesh.triangles[i];
    const auto corner = [&](size_t k) { return lattice.to_lattice(mesh.vertices[t[k]]); };
    reached.find_near(corner(0), corner(1), corner(2));
  });
  return static_cast<double>(reached.missed()) / static_cast<double>(picked.size());
}

}  // namespace

SelfCheckReport self_check(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                           const Parallel& parallel) {
  SelfCheckReport report;
  const std::vector<Vec3d> picked = picked_samples(samples);
  report.samples = picked.size();
  if (picked.empty()) return report;
  report.lost = lost_share(mesh, picked, lattice, parallel);
  if (!(mesh.area() > 0)) return report;
  const std::vector<MeshPoint> places = sample_mesh(mesh, most_picked, seed, parallel);
  report.places = places.size();
  // Just beyond the reach, for which the clamped distance is more than it.
  constexpr double limit = self_check_reach + 0.01;
  const auto far = sum_chunks<size_t>(places.size(), 256, parallel, [&](size_t begin, size_t end) {
    size_t count = 0;
    for (size_t i = begin; i < end; ++i)
      count += distance_to_samples(samples, lattice.to_lattice(places[i].position), self_check_reach, limit) >
               self_check_reach;
    return count;
  });
  report.invented = static_cast<double>(far) / static_cast<double>(places.size());
  return report;
}

}  // namespace soapfilm
