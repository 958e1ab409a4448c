#include "soapfilm/finish/self_check.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/some_by_place.h"
#include "soapfilm/core/triangle_distance.h"
#include "soapfilm/finish/nearest_sample.h"
#include "soapfilm/finish/on_surface.h"

namespace soapfilm {

namespace {

constexpr size_t most_picked = 20000;
constexpr uint64_t seed = 20000;

/// Samples chosen by their places.
struct Picked {
  std::vector<Vec3d> places;  ///< lattice coordinates
  std::vector<float> weights;

  /// The share of some of them, by weight.
  double share_of(const std::vector<uint32_t>& some) const {
    double part = 0, all = 0;
    for (const uint32_t i : some) part += weights[i];
    for (const float weight : weights) all += weight;
    return part / all;
  }
};

Picked picked_samples(const GridSamples& samples, const Context& context) {
  const auto place_of = [&](size_t s) {
    const auto after = std::upper_bound(samples.begin.begin(), samples.begin.end(), s);
    const auto brick = static_cast<size_t>(after - samples.begin.begin()) - 1;
    return Vec3d(samples.bricks.first_vertex(brick)) + Vec3d(samples.local[s]);
  };
  Box3d box;
  for (size_t b = 0; b < samples.bricks.size(); ++b) box.extend(Vec3d(samples.bricks.first_vertex(b)));
  Picked picked;
  const auto some = some_by_place(box, samples.size(), most_picked, context, place_of);
  for (const uint32_t s : std::span(some).first(std::min(some.size(), most_picked))) {
    picked.places.push_back(place_of(s));
    picked.weights.push_back(samples.weight_of(s));
  }
  return picked;
}

/// Points, hashed by the cubes of 8 voxels within their reach: the points near a vertex or a triangle are in the lists
/// of the cubes that it intersects. Cubes with equal hashes share a list: that only costs time.
class Reached {
 public:
  Reached(const std::vector<Vec3d>& places, double reach)
      : places_(places), reach_(reach), found_(places.size()), begin_(lists + 1), wanted_(places.size()) {
    std::iota(wanted_.begin(), wanted_.end(), 0u);
    index_wanted();
  }

  void find_near(Vec3d vertex) {
    for_each_in(list_of(brick_around(vertex)), [&](uint32_t i) {
      const Vec3d d = places_[i] - vertex;
      return dot(d, d) <= reach_ * reach_;
    });
  }

  void find_near(Vec3d a, Vec3d b, Vec3d c) {
    const auto least = [&](int axis) { return std::min({a[axis], b[axis], c[axis]}); };
    const auto most = [&](int axis) { return std::max({a[axis], b[axis], c[axis]}); };
    const Vec3d lo{least(0), least(1), least(2)}, hi{most(0), most(1), most(2)};
    for_each_cube(lo, hi, [&](size_t list) {
      for_each_in(list, [&](uint32_t i) {
        const Vec3d p = places_[i];
        for (int axis = 0; axis < 3; ++axis)
          if (p[axis] < lo[axis] - reach_ || p[axis] > hi[axis] + reach_) return false;
        return squared_distance(p, a, b, c) <= reach_ * reach_;
      });
    });
  }

  /// Restricts further searches to the points not found yet, and returns these.
  const std::vector<uint32_t>& keep_missed() {
    std::erase_if(wanted_, [&](uint32_t i) { return found_[i].load(std::memory_order_relaxed) != 0; });
    index_wanted();
    return wanted_;
  }

 private:
  static constexpr size_t lists = size_t{1} << 17;

  static size_t list_of(Vec3i cube) {
    // As in Teschner et al. 2003, Optimized Spatial Hashing.
    const auto times = [](int32_t i, uint32_t prime) { return static_cast<uint32_t>(i) * prime; };
    const uint32_t mixed = times(cube.x, 73856093u) ^ times(cube.y, 19349663u) ^ times(cube.z, 83492791u);
    return (mixed ^ mixed >> 15) % lists;
  }

  template <class Visit>
  static void for_each_cube(Vec3d lo, Vec3d hi, Visit&& visit) {
    const Vec3i first = brick_around(lo), last = brick_around(hi);
    for (int32_t z = first.z; z <= last.z; ++z)
      for (int32_t y = first.y; y <= last.y; ++y)
        for (int32_t x = first.x; x <= last.x; ++x) visit(list_of({x, y, z}));
  }

  void index_wanted() {
    const Vec3d reach{reach_, reach_, reach_};
    const auto for_each_list = [&](auto&& visit) {
      for (const uint32_t i : wanted_)
        for_each_cube(places_[i] - reach, places_[i] + reach, [&](size_t list) { visit(list, i); });
    };
    std::fill(begin_.begin(), begin_.end(), 0u);
    for_each_list([&](size_t list, uint32_t) { ++begin_[list + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    in_list_.resize(begin_.back());
    std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
    for_each_list([&](size_t list, uint32_t i) { in_list_[next[list]++] = i; });
  }

  template <class IsNear>
  void for_each_in(size_t list, IsNear&& is_near) {
    for (uint32_t k = begin_[list]; k < begin_[list + 1]; ++k) {
      std::atomic<uint8_t>& found = found_[in_list_[k]];
      if (!found.load(std::memory_order_relaxed) && is_near(in_list_[k])) found.store(1, std::memory_order_relaxed);
    }
  }

  const std::vector<Vec3d>& places_;
  const double reach_;
  std::vector<std::atomic<uint8_t>> found_;  // only ever set: the order of threads does not matter
  std::vector<uint32_t> begin_, in_list_;    // of each list
  std::vector<uint32_t> wanted_;
};

/// Which of the chosen samples lie farther than the reach from the mesh. Nearly all samples are near a corner of every
/// eighth triangle: about seven of these lie within 3 voxels of a point on the surface. Only the others are tested
/// against whole triangles.
std::vector<uint32_t> lost_of(const std::vector<Vec3d>& picked, double reach, const Mesh& mesh, const Lattice& lattice,
                              const Context& context) {
  constexpr size_t step = 8;
  Reached reached(picked, reach);
  parallel_for(context, (mesh.triangles.size() + step - 1) / step, 4096,
               [&](size_t k) { reached.find_near(lattice.to_lattice(mesh.vertices[mesh.triangles[k * step][0]])); });
  if (reached.keep_missed().empty()) return {};
  parallel_for(context, mesh.triangles.size(), 4096, [&](size_t i) {
    const Triangle& t = mesh.triangles[i];
    const auto corner = [&](size_t k) { return lattice.to_lattice(mesh.vertices[t[k]]); };
    reached.find_near(corner(0), corner(1), corner(2));
  });
  return reached.keep_missed();
}

/// What is around the lost samples, or around some of them.
void look_around_lost(const std::vector<Vec3d>& picked, const std::vector<uint32_t>& lost, const GridSamples& samples,
                      SelfCheckReport& report) {
  constexpr size_t enough = 400;
  if (lost.empty()) return;
  const size_t step = (lost.size() + enough - 1) / enough;
  size_t outliers = 0, alone = 0, looked_at = 0;
  for (size_t k = 0; k < lost.size(); k += step, ++looked_at) {
    const Company company = company_of(samples, picked[lost[k]]);
    outliers += company != Company::surface;
    alone += company == Company::few;
  }
  report.outliers = static_cast<double>(outliers) / static_cast<double>(looked_at);
  report.alone = static_cast<double>(alone) / static_cast<double>(looked_at);
}

/// Standard deviation of normal noise, as a multiple of `reach`, if a share `beyond` of it is farther than that from
/// the mean.
double noise_of(double beyond) {
  double lo = 0, hi = 10;  // of reach over the deviation
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (lo + hi) / 2;
    (std::erfc(middle / std::sqrt(2.0)) > beyond ? lo : hi) = middle;
  }
  return 2 / (lo + hi);
}

/// Noise loses samples everywhere along its surface: then about as many lie beyond half the reach as for a normal
/// distribution. Where parts of a surface are lost, the other samples are near it.
double noise_of_lost(const Picked& picked, double lost, const Mesh& mesh, const Lattice& lattice,
                     const Context& context) {
  constexpr double alike = 0.8;
  const double noise = noise_of(lost);
  const double far = picked.share_of(lost_of(picked.places, self_check_reach / 2, mesh, lattice, context));
  const double expected = std::erfc(1 / (2 * noise * std::sqrt(2.0)));
  return far > alike * expected ? noise * self_check_reach : 0;
}

struct Area {
  double all = 0, far = 0;
  void operator+=(const Area& other) { all += other.all, far += other.far; }
};

/// Tests one random point per interval of the triangles, which stands for the interval's area; small meshes have
/// several on each triangle.
Area invented_area(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, const Context& context,
                   size_t& places) {
  const size_t triangles = mesh.triangles.size();
  if (triangles == 0) return {};
  const size_t stretch = (triangles + most_picked - 1) / most_picked;
  const size_t stretches = (triangles + stretch - 1) / stretch, repeats = most_picked / stretches;
  places = stretches * repeats;
  // Just beyond the reach, so that clamped distances can exceed it.
  constexpr double limit = self_check_reach + 0.01;
  return sum_chunks<Area>(places, 256, context, [&](size_t begin, size_t end) {
    Area part;
    for (size_t k = begin; k < end; ++k) {
      Random random(Random(seed + k).next());
      const Triangle& t = mesh.triangles[one_of_stretch(k % stretches, stretch, triangles)];
      // Uniform in a triangle: sqrt of one number, the other unchanged (Turk 1990).
      const double r = std::sqrt(random.uniform()), s = random.uniform();
      const Vec3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]] - a, c = mesh.vertices[t[2]] - a;
      const double area = norm(cross(b, c));
      const Vec3d place = lattice.to_lattice(a + b * (r * (1.0 - s)) + c * (r * s));
      const bool far = distance_to_samples(samples, place, self_check_reach, limit) > self_check_reach;
      part += {area, far ? area : 0.0};
    }
    return part;
  });
}

}  // namespace

SelfCheckReport self_check(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                           const Context& context) {
  SelfCheckReport report;
  const Picked picked = picked_samples(samples, context);
  report.samples = picked.places.size();
  if (picked.places.empty()) return report;
  const std::vector<uint32_t> lost = lost_of(picked.places, self_check_reach, mesh, lattice, context);
  report.lost = picked.share_of(lost);
  look_around_lost(picked.places, lost, samples, report);
  if (report.lost > self_check_most_lost && report.lost < 0.5)
    report.noise = noise_of_lost(picked, report.lost, mesh, lattice, context);
  context.progress().advance(0.6, "samples");
  size_t places = 0;
  const Area area = invented_area(mesh, samples, lattice, context, places);
  if (!(area.all > 0)) return report;
  report.places = places;
  report.invented = area.far / area.all;
  return report;
}

}  // namespace soapfilm
