#include "soapfilm/fuse/vrip.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

constexpr size_t triangles_per_task = 1024;
constexpr size_t bricks_per_task = 4;

/// Bricks from lo to hi, both included; empty when lo > hi along some axis.
struct BrickBox {
  Vec3i lo, hi;
};

template <class Visit>
void for_each_brick(const BrickBox& box, Visit&& visit) {
  for (int z = box.lo.z; z <= box.hi.z; ++z)
    for (int y = box.lo.y; y <= box.hi.y; ++y)
      for (int x = box.lo.x; x <= box.hi.x; ++x) visit(Vec3i{x, y, z});
}

/// The distances over which a scan has influence, voxels: see VripParams.
struct Ramp {
  double front, behind;

  /// Falls over the outer half of either side; `height` > 0 in front.
  double weight(double height) const {
    return std::clamp(2 - 2 * (height > 0 ? height / front : -height / behind), 0.0, 1.0);
  }
};

/// A triangle seen from the scanner: the prism of lines of sight through it, cut off in front and behind at the ends of
/// the ramp. All in voxels, relative to a nearby origin.
class SightPrism {
 public:
  SightPrism(const std::array<Vec3d, 3>& corners, const Viewpoint& view, Ramp ramp)
      : corners_(corners),
        view_(view),
        ramp_(ramp),
        normal_(normalized(cross(corners[1] - corners[0], corners[2] - corners[0]))) {
    for (int k = 0; k < 3; ++k) {
      const Vec3d a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
      // Through the lines of sight of the edge opposite corner k, positive on the triangle's side: the three values at
      // x are proportional to the barycentric coordinates of where the line of sight through x meets the triangle.
      side_[k] = view.is_central() ? cross(b - view.vector(), a - view.vector()) : cross(b - a, -view.vector());
      // Rounding must not open a gap between neighbors.
      slack_[k] = 1e-9 * std::abs(dot(side_[k], corners[k] - a));
    }
  }

  Box3d box() const {
    constexpr double least_cosine = 0.01;  // rays to the corners differ from the one that range_surface() has checked
    Box3d box;
    for (const Vec3d& p : corners_) {
      const Vec3d ray = view_.from(p);
      const double cosine = std::max(dot(normal_, ray), least_cosine);
      box.extend(p + ray * (ramp_.front / cosine));
      box.extend(p - ray * (ramp_.behind / cosine));
    }
    return box;
  }

  /// Visits the vertices of the brick at the origin that lie in the prism.
  template <class Visit>
  void for_each_vertex(Visit&& visit) const {
    const Box3d around = box();
    const auto first = [](double lo) { return static_cast<int>(std::ceil(std::clamp<double>(lo, 0, brick_side))); };
    const auto last = [](double hi) {
      return static_cast<int>(std::floor(std::clamp<double>(hi, -1, brick_side - 1)));
    };
    for (int z = first(around.lo.z); z <= last(around.hi.z); ++z) {
      for (int y = first(around.lo.y); y <= last(around.hi.y); ++y) {
        const auto [lo, hi] = run(y, z);
        for (int x = first(lo); x <= last(hi); ++x) visit(Vec3i{x, y, z});
      }
    }
  }

  /// Distance above the triangle's plane, towards the scanner.
  double height_of(Vec3d x) const { return dot(normal_, x - corners_[0]); }
  /// Along the line of sight; > 0 in front of the triangle.
  double distance_of(Vec3d x) const { return height_of(x) / dot(normal_, view_.from(x)); }
  /// Barycentric coordinates of where the line of sight through x meets the triangle.
  std::array<double, 3> coordinates_of(Vec3d x) const {
    std::array<double, 3> b{};
    for (int k = 0; k < 3; ++k) b[k] = std::max(0.0, side_value(k, x));
    const double sum = b[0] + b[1] + b[2];
    for (double& c : b) c /= sum;
    return b;
  }

 private:
  double side_value(int k, Vec3d x) const { return dot(side_[k], x - corners_[(k + 1) % 3]); }

  /// The part of the brick's row (y, z) that lies in the prism, from first to second; empty when first > second.
  std::pair<double, double> run(int y, int z) const {
    double lo = 0, hi = brick_side - 1;
    // Keeps the x where slope * x + value >= 0.
    const auto clip = [&](double slope, double value) {
      if (slope > 0) {
        lo = std::max(lo, -value / slope);
      } else if (slope < 0) {
        hi = std::min(hi, -value / slope);
      } else if (value < 0) {
        hi = -1;
      }
    };
    const Vec3d start{0, static_cast<double>(y), static_cast<double>(z)};
    for (int k = 0; k < 3; ++k) clip(side_[k].x, side_value(k, start) + slack_[k]);
    const double height = height_of(start);
    clip(normal_.x, height + ramp_.behind);
    clip(-normal_.x, ramp_.front - height);
    return {lo, hi};
  }

  std::array<Vec3d, 3> corners_;
  Viewpoint view_;
  Ramp ramp_;
  Vec3d normal_;
  std::array<Vec3d, 3> side_;
  std::array<double, 3> slack_;
};

/// One scan in lattice coordinates.
struct PlacedScan {
  std::vector<Vec3d> positions;
  Viewpoint view;
  const RangeSurface& surface;

  PlacedScan(const RangeScans& scans, const Scan& scan, const RangeSurface& range, const Lattice& lattice)
      : view(scan, scans.sensor), surface(range) {
    positions.reserve(scan.size());
    for (size_t i = scan.begin; i < scan.end; ++i) positions.push_back(lattice.to_lattice(scans.cloud.positions[i]));
    view = view.is_central() ? Viewpoint::central(lattice.to_lattice(view.vector()))
                             : Viewpoint::parallel(lattice.from_world_axes(view.vector()));
  }

  SightPrism prism(size_t triangle, Vec3d origin, Ramp ramp) const {
    const Triangle& t = surface.triangles[triangle];
    const Viewpoint from_origin = view.is_central() ? Viewpoint::central(view.vector() - origin) : view;
    return {{positions[t[0]] - origin, positions[t[1]] - origin, positions[t[2]] - origin}, from_origin, ramp};
  }
};

/// The nearest triangle of one scan on the line of sight of each vertex of a brick.
struct Sightings {
  std::array<double, brick_volume> distance;  // > 0 in front
  std::array<double, brick_volume> weight;

  Sightings() {
    distance.fill(std::numeric_limits<double>::infinity());
    weight.fill(0);
  }
};

class Fusion {
 public:
  Fusion(const RangeScans& scans, const Lattice& lattice, const VripParams& params, const Context& context)
      : scans_(scans), lattice_(lattice), ramp_{params.front, params.behind}, context_(context) {
    surfaces_.resize(scans_.cloud.scans.size());
    parallel_for(context, surfaces_.size(), 1, [&](size_t k) {
      surfaces_[k] = range_surface(scans_.cloud, scans_.cloud.scans[k], params.surface, scans_.sensor);
    });
  }

  FusedField run(VripReport& report) {
    BrickMask near(lattice_.box(0).bricks);
    for (size_t k = 0; k < surfaces_.size(); ++k) {
      for (const BrickBox& box : boxes_of(place(k))) for_each_brick(box, [&](Vec3i b) { near.set(b); });
      report.triangles += surfaces_[k].triangles.size();
      report.dropped_triangles += surfaces_[k].dropped;
    }
    report.scans = surfaces_.size();
    if (near.count() == 0)
      throw ParameterError(fmt::format("vrip: the {} scan{} give {} triangles and {} dropped ones, none near the grid",
                                       report.scans, report.scans == 1 ? "" : "s", report.triangles,
                                       report.dropped_triangles));
    fused_.grid = BrickGrid(near, context_);
    fused_.distance = Field<float>(fused_.grid, pages_of(context_));
    fused_.weight = Field<float>(fused_.grid, pages_of(context_));
    for (size_t k = 0; k < surfaces_.size(); ++k) {
      add(place(k));
      context_.progress().advance(static_cast<double>(k + 1) / static_cast<double>(surfaces_.size()),
                                  fmt::format("scan {} of {}", k + 1, surfaces_.size()));
    }
    for (size_t b = 0; b < fused_.grid.size(); ++b) {
      const float* weight = fused_.weight.brick(b);
      report.vertices_seen +=
          static_cast<size_t>(std::count_if(weight, weight + brick_volume, [](float w) { return w > 0; }));
    }
    return std::move(fused_);
  }

 private:
  PlacedScan place(size_t k) const { return {scans_, scans_.cloud.scans[k], surfaces_[k], lattice_}; }

  /// For each triangle the bricks that its prism may reach.
  std::vector<BrickBox> boxes_of(const PlacedScan& scan) const {
    const Vec3i bricks = lattice_.box(0).bricks;
    std::vector<BrickBox> boxes(scan.surface.triangles.size());
    parallel_for(context_, boxes.size(), triangles_per_task, [&](size_t t) {
      const Box3d box = scan.prism(t, {}, ramp_).box();
      for (int axis = 0; axis < 3; ++axis) {
        // In double: a prism may lie anywhere.
        const double last = brick_side * static_cast<double>(bricks[axis]) - 1;
        const double lo = std::clamp(std::ceil(box.lo[axis]), 0.0, last + 1);
        const double hi = std::clamp(std::floor(box.hi[axis]), -1.0, last);
        boxes[t].lo[axis] = static_cast<int>(lo) >> 3;
        boxes[t].hi[axis] = lo <= hi ? static_cast<int>(hi) >> 3 : (static_cast<int>(lo) >> 3) - 1;
      }
    });
    return boxes;
  }

  void add(const PlacedScan& scan) {
    const std::vector<BrickBox> boxes = boxes_of(scan);
    // The triangles near each brick, in their order.
    std::vector<size_t> begin(fused_.grid.size() + 1, 0);
    const auto index = [&](Vec3i b) { return static_cast<size_t>(fused_.grid.find(b)); };
    for (const BrickBox& box : boxes) for_each_brick(box, [&](Vec3i b) { ++begin[index(b)]; });
    std::vector<size_t> touched;
    size_t sum = 0;
    for (size_t b = 0; b < begin.size(); ++b) {
      if (begin[b] > 0) touched.push_back(b);
      begin[b] = sum += begin[b];
    }
    std::vector<uint32_t> triangles(sum);
    for (size_t t = boxes.size(); t-- > 0;)
      for_each_brick(boxes[t], [&](Vec3i b) { triangles[--begin[index(b)]] = static_cast<uint32_t>(t); });

    parallel_for(context_, touched.size(), bricks_per_task, [&](size_t i) {
      const size_t b = touched[i];
      accumulate(
          b, look(scan, fused_.grid.first_vertex(b), std::span(triangles).subspan(begin[b], begin[b + 1] - begin[b])));
    });
  }

  Sightings look(const PlacedScan& scan, Vec3i first_vertex, std::span<const uint32_t> triangles) const {
    Sightings seen;
    for (const uint32_t t : triangles) {
      const SightPrism prism = scan.prism(t, Vec3d(first_vertex), ramp_);
      const Triangle& corners = scan.surface.triangles[t];
      prism.for_each_vertex([&](Vec3i v) {
        const Vec3d x(v);
        const auto i = static_cast<size_t>(brick_offset(v.x, v.y, v.z));
        const double distance = prism.distance_of(x);
        if (!(std::abs(distance) < std::abs(seen.distance[i]))) return;
        const auto b = prism.coordinates_of(x);
        double weight = 0;
        for (size_t k = 0; k < 3; ++k) weight += b[k] * static_cast<double>(scan.surface.weight[corners[k]]);
        seen.distance[i] = distance;
        seen.weight[i] = weight * ramp_.weight(prism.height_of(x));
      });
    }
    return seen;
  }

  /// Curless and Levoy 1996, equations (3) and (4).
  void accumulate(size_t brick, const Sightings& seen) {
    float* distance = fused_.distance.brick(brick);
    float* weight = fused_.weight.brick(brick);
    for (size_t i = 0; i < brick_volume; ++i) {
      if (!(seen.weight[i] > 0)) continue;
      const double before = weight[i];
      const double sum = before + seen.weight[i];
      distance[i] = static_cast<float>((before * distance[i] - seen.weight[i] * seen.distance[i]) / sum);
      weight[i] = static_cast<float>(sum);
    }
  }

  RangeScans scans_;
  const Lattice& lattice_;
  Ramp ramp_;
  const Context& context_;
  std::vector<RangeSurface> surfaces_;
  FusedField fused_;
};

}  // namespace

FusedField fuse_scans(const RangeScans& scans, const Lattice& lattice, const VripParams& params, const Context& context,
                      VripReport& report) {
  const auto check_ramp = [](const char* name, double value) {
    if (!(value > 0 && value <= 1000))
      throw ParameterError(fmt::format("{} = {}, must be > 0 and <= 1000 voxels", name, value));
  };
  check_ramp("front", params.front);
  check_ramp("behind", params.behind);
  validate(params.surface);
  const PointCloud& cloud = scans.cloud;
  if (cloud.scans.empty()) throw ParameterError("vrip needs range scans: the cloud has none");
  for (size_t i = 0; i < cloud.size(); ++i)
    if (!is_finite(cloud.positions[i])) throw ParameterError(fmt::format("sample {}: position is not finite", i));
  report = {};
  return Fusion(scans, lattice, params, context).run(report);
}

}  // namespace soapfilm
