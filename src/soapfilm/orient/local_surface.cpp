#include "soapfilm/orient/local_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "soapfilm/core/gather.h"
#include "soapfilm/orient/area_weights.h"
#include "soapfilm/orient/sample_cells.h"

namespace soapfilm {

namespace {

constexpr int fewest_cells = 6;           // of 27: a plane passes through 9 to 13
constexpr double least_spread = 0.15;     // middle over largest variance: below it the samples lie along a line
constexpr double most_thick = 0.08;       // least over middle variance of a plane
constexpr double most_thick_far = 0.04;   // the same in cells larger than the first ones that are filled
constexpr int coarser_at_most = 3;        // depths above the first filled one where a plane is looked for
constexpr int coarsest = 4;               // depth: a sixteenth of the box
constexpr double least_incidence = 0.05;  // cosine of direction and normal, below which sides are not told apart
constexpr double least_agreement = 0.75;  // length of the mean direction; random ones on one side have a half
constexpr double most_outnumbered = 8;    // by samples seen from the other side; beyond it they are outliers
constexpr double few_others = 0.1;        // of the other side, so few that it says nothing that the views differ
constexpr double parts_per_face = 16;     // of a cell's parts, those that a plane along its face meets

/// Area of a sample over the mean one, from which on it has to be confirmed at the next depth.
constexpr double large = 1.5;
// By what: as thin and as agreeing as two faces of a box that meet, its normal at most halfway between theirs.
constexpr double most_thick_again = 0.35;
constexpr double least_agreement_again = 0.65;
constexpr float least_along_again = 0.65f;  // cosine of the normals
/// An edge, a rod: there the directions must agree still better at the next depth, as those towards one scanner do.
constexpr double least_agreement_of_edges = 0.9;

/// Of a sample. One that would count for far more area than others has to show the same plane at the next depth, too:
/// six outliers may lie in a plane, but with those around them they no longer do.
enum class State : uint8_t { settled, open, found, to_confirm };

/// Where the samples of a facet are settled.
struct FacetPlane {
  Vec3f normal{};
  float area = 0;     ///< cells^2 for each sample
  float spacing = 0;  ///< cells
  bool filled = false;
  bool found = false;
  bool found_far = false;  ///< thin enough for cells larger than the first filled ones, too
  double thick = 1;        ///< least over middle variance
  double agreement = 0;    ///< length of the mean direction around: outliers' are all different
  bool one_sided = false;  ///< directions around are on one side of the plane, however much they differ
  PlaneSides sides;

  bool agrees() const { return agreement >= least_agreement || (found && one_sided); }
  bool confirms(Vec3f normal_before) const {
    return thick <= most_thick_again && (agreement >= least_agreement_again || one_sided) &&
           std::abs(dot(normal, normal_before)) >= least_along_again;
  }
};

/// The facets around one, relative to the center of its cell.
struct Around {
  std::array<Vec3f, 54> mean;
  std::array<const Facet*, 54> facet;
  std::array<int8_t, 54> slot;
  size_t count = 0;
};

struct Spread {
  Eigen::Vector3d variance;
  Vec3f normal;
};

template <class Wanted>
Spread spread_of(const Around& around, Wanted&& wanted) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  double count = 0;
  for (size_t k = 0; k < around.count; ++k) {
    if (!wanted(k)) continue;
    const Eigen::Vector3d v(around.mean[k].x, around.mean[k].y, around.mean[k].z);
    mean += v;
    moments += v * v.transpose();
    ++count;
  }
  mean /= count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments / count - mean * mean.transpose());
  const Eigen::Vector3d n = solver.eigenvectors().col(0);
  return {solver.eigenvalues(), normalized(Vec3f(Vec3d{n.x(), n.y(), n.z()}))};
}

/// Cells, of 27, that hold a wanted facet.
template <class Wanted>
int cells_with(const Around& around, Wanted&& wanted) {
  uint32_t cells = 0;
  for (size_t k = 0; k < around.count; ++k)
    if (wanted(k)) cells |= 1u << around.slot[k];
  return std::popcount(cells);
}

/// Mean of a Poisson distribution whose mean without zeros is `seen` >= 1 (Newton's method from above).
double mean_with_zeros(double seen) {
  double mean = seen;
  for (int k = 0; k < 8; ++k) {
    const double e = std::exp(-mean);
    const double value = mean - seen * (1 - e), slope = 1 - seen * e;
    if (slope <= 0.05 || value < 1e-3 * mean) break;
    mean = std::max(mean - value / slope, 0.05);
  }
  return mean;
}

/// Area of a plane inside the 27 cells, cells^2; it passes through the middle of the wanted facets.
template <class Wanted>
double block_area(const Around& around, Wanted&& wanted, Vec3f n) {
  Vec3f middle{};
  float count = 0;
  for (size_t k = 0; k < around.count; ++k) {
    if (!wanted(k)) continue;
    middle = middle + around.mean[k];
    ++count;
  }
  const float offset = dot(n, middle) / count;
  // Over a raster of the coordinate plane that it lies flattest on.
  float up = std::abs(n.x), a = n.y, b = n.z;
  if (std::abs(n.y) > up) up = std::abs(n.y), a = n.x, b = n.z;
  if (std::abs(n.z) > up) up = std::abs(n.z), a = n.x, b = n.y;
  constexpr int steps = 5;
  int inside = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const float x = (static_cast<float>(i) + 0.5f) / steps * 3 - 1.5f;
      const float y = (static_cast<float>(j) + 0.5f) / steps * 3 - 1.5f;
      inside += std::abs(offset - a * x - b * y) <= 1.5f * up;
    }
  return 9.0 * inside / (steps * steps) / up;
}

/// The same plane's own side: area for each sample and spacing of different ones, in cells. A plane meets
/// |n_x| + |n_y| + |n_z| cells per cell^2 of its area.
template <class Wanted>
void measure_area(const Around& around, Wanted&& wanted, FacetPlane& plane) {
  const int cells = cells_with(around, wanted);
  double samples = 0, distinct = 0, others = 0;
  Vec3f direction{};
  for (size_t k = 0; k < around.count; ++k) {
    if (!wanted(k)) {
      others += around.facet[k]->count;
      continue;
    }
    samples += around.facet[k]->count;
    distinct += std::popcount(around.facet[k]->parts);
    direction += around.facet[k]->direction;
  }
  plane.agreement = others <= most_outnumbered * samples ? norm(direction) / samples : 0;
  plane.one_sided = others <= few_others * samples;
  const Vec3f n = plane.normal;
  const double per_area = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  // Parts that several samples share count once: how many there were if each had a place of its own.
  const double parts = parts_per_face * cells;
  const double apart = -parts * std::log1p(-std::min(distinct / parts, 0.95));
  const double in_cell = mean_with_zeros(std::max(apart / cells, 1.0 + 1e-3));
  // Cells, those without samples included; but no more than the plane passes through (samples in a raster leave none
  // out). Cells that a plane cuts the corners of are missed more often: by how much was measured on spheres, planes,
  // rasters and lines of samples, whose areas come out within 17 %.
  const double at_most = std::max<double>(cells, per_area * block_area(around, wanted, n));
  const double met = std::min(apart / in_cell, at_most) * (1.05 + 0.47 * (per_area - 1));
  plane.area = static_cast<float>(met / per_area / samples);
  plane.spacing = static_cast<float>(std::sqrt(met / per_area / apart));
}

PlaneSides sides_of(const Around& around, const FacetPlane& plane) {
  PlaneSidesOfCells sides;
  for (size_t k = 0; k < around.count; ++k) {
    const Facet& facet = *around.facet[k];
    sides.add(around.slot[k], facet.count, dot(facet.direction, plane.normal), dot(around.mean[k], plane.normal));
  }
  return sides.result(plane.spacing);
}

/// To some four digits: what is left of rounding when the axes are turned must not reach the mesh.
float rounded(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return static_cast<float>(std::ldexp(std::round(mantissa * 4096) / 4096, exponent));
}

Vec3f rounded(Vec3f unit) {
  constexpr float steps = 16384;
  return normalized(Vec3f{std::round(unit.x * steps), std::round(unit.y * steps), std::round(unit.z * steps)});
}

class Survey {
 public:
  Survey(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Box3d& box,
         const Parallel& parallel, Progress& progress)
      : positions_(positions),
        directions_(directions),
        order_(positions, box, parallel),
        parallel_(parallel),
        progress_(progress),
        first_filled_(positions.size(), 0),
        state_(positions.size(), State::open) {
    surface_.area.assign(positions.size(), 0);
    surface_.spacing.assign(positions.size(), 0);
    surface_.normal.assign(positions.size(), {});
  }

  LocalSurface run() {
    int depth = first_depth();
    SampleCells cells(order_, positions_, directions_, depth, parallel_);
    while (true) {
      progress_.check();
      const Settled settled = settle(cells, depth);
      surface_.sides += settled.sides;
      size_t left = settled.left;
      left += doubt_large_ones();
      if (left == 0 || depth == coarsest) break;
      cells = std::move(cells).coarser(directions_, parallel_);
      --depth;
    }
    surface_.planes = 0;
    for (size_t i = 0; i < positions_.size(); ++i) {
      const bool edge = surface_.normal[i] == Vec3f{} && first_filled_[i] == coarsest;
      if (edge || state_[i] == State::to_confirm) surface_.spacing[i] = 0;  // no coarser cells tell
      surface_.planes += surface_.is_plane(i);
    }
    surface_.coverage = cover_area(surface_);
    return std::move(surface_);
  }

 private:
  /// The finest depth where some cells hold several different samples.
  int first_depth() const {
    constexpr double some = 0.02;
    constexpr uint64_t several = 4;
    for (int depth = SampleOrder::deepest - 2; depth > coarsest; --depth) {
      const int up = 3 * (SampleOrder::deepest - depth), up_parts = up - 6;
      size_t cells = 0, crowded = 0;
      uint64_t distinct = 0;
      for (size_t k = 0; k < order_.size(); ++k) {
        const bool is_new = k == 0 || order_.key(k) >> up != order_.key(k - 1) >> up;
        if (is_new) {
          ++cells;
          distinct = 1;
        } else if (order_.key(k) >> up_parts != order_.key(k - 1) >> up_parts) {
          crowded += ++distinct == several;
        }
      }
      if (static_cast<double>(crowded) >= some * static_cast<double>(cells)) return depth;
    }
    return coarsest;
  }

  /// Of the planes found at this depth, those that count for far more area than others must be confirmed; how many.
  size_t doubt_large_ones() {
    constexpr size_t at_once = size_t{1} << 15;
    struct Sum {
      size_t planes = 0;
      double area = 0;
      void operator+=(const Sum& other) { planes += other.planes, area += other.area; }
    };
    const auto sum = sum_chunks<Sum>(positions_.size(), at_once, parallel_, [&](size_t begin, size_t end) {
      Sum part;
      for (size_t i = begin; i < end; ++i)
        if (surface_.is_plane(i)) part += {1, surface_.area[i]};
      return part;
    });
    const double per_area = sum.planes > 0 ? static_cast<double>(sum.planes) / sum.area : 0;
    return sum_chunks<size_t>(positions_.size(), at_once, parallel_, [&](size_t begin, size_t end) {
      size_t doubted = 0;
      for (size_t i = begin; i < end; ++i) {
        if (state_[i] != State::found) continue;
        const bool doubt = surface_.is_plane(i) && surface_.area[i] * per_area > large;
        state_[i] = doubt ? State::to_confirm : State::settled;
        doubted += doubt;
      }
      return doubted;
    });
  }

  struct Settled {
    size_t left = 0;  ///< samples that are not
    SideTally sides;  ///< of those that now are
    void operator+=(const Settled& other) { left += other.left, sides += other.sides; }
  };

  /// Settles the samples whose surface shows at this depth.
  Settled settle(const SampleCells& cells, int depth) {
    return sum_chunks<Settled>(cells.size(), 512, parallel_, [&](size_t begin, size_t end) {
      Settled settled;
      for (size_t c = begin; c < end; ++c) settled.left += settle_cell(cells, c, depth, settled.sides);
      return settled;
    });
  }

  /// Tells how many samples of the cell are left.
  size_t settle_cell(const SampleCells& cells, size_t c, int depth, SideTally& sides) {
    const uint32_t first = cells[c].begin, last = cells[c + 1].begin;
    bool any = false;
    for (uint32_t k = first; k < last && !any; ++k) any = state_[order_.sample(k)] != State::settled;
    if (!any) return 0;
    const Around around = look_around(cells, c);
    std::array<std::optional<FacetPlane>, 2> planes;
    std::array<size_t, 2> found_now{};
    size_t left = 0;
    for (uint32_t k = first; k < last; ++k) {
      const uint32_t i = order_.sample(k);
      if (state_[i] == State::settled) continue;
      const size_t side = cells.side_of(k);
      if (!planes[side]) planes[side] = plane_of(around, cells.facets(c)[side]);
      const FacetPlane& plane = *planes[side];
      if (state_[i] == State::to_confirm) {
        state_[i] = State::settled;
        if (!plane.confirms(surface_.normal[i])) surface_.spacing[i] = 0;
        continue;
      }
      const bool is_first = first_filled_[i] == 0;
      if (first_filled_[i] == depth + 1 && plane.agreement < least_agreement_of_edges) surface_.spacing[i] = 0;
      const bool found = is_first ? plane.found : plane.found_far;
      if (plane.filled && (found || is_first)) {
        surface_.area[i] = rounded(plane.area * cells.side() * cells.side());
        surface_.spacing[i] = plane.agrees() ? rounded(plane.spacing * cells.side()) : 0.0f;
      }
      if (plane.filled && is_first) first_filled_[i] = static_cast<uint8_t>(depth);
      if (found) {
        surface_.normal[i] = rounded(plane.normal);
        state_[i] = State::found;
        found_now[side] += plane.agrees();
        continue;
      }
      if (first_filled_[i] >= depth + coarser_at_most) state_[i] = State::settled;  // an edge, or no surface
      left += state_[i] != State::settled;
    }
    const double cell = cells.side() / order_.longest();
    for (size_t side = 0; side < 2; ++side)
      if (found_now[side] > 0) sides.add(planes[side]->sides, found_now[side], planes[side]->area * cell * cell, cell);
    return left;
  }

  static Around look_around(const SampleCells& cells, size_t c) {
    Around around;
    const std::array<uint32_t, 27> near = cells.around(c);
    for (int slot = 0; slot < 27; ++slot) {
      const uint32_t cell = near[static_cast<size_t>(slot)];
      if (cell == SampleCells::none) continue;
      const Vec3f d{static_cast<float>(slot % 3 - 1), static_cast<float>(slot / 3 % 3 - 1),
                    static_cast<float>(slot / 9 - 1)};
      for (const Facet& facet : cells.facets(cell)) {
        if (facet.count == 0) continue;
        around.mean[around.count] = facet.mean + d;
        around.facet[around.count] = &facet;
        around.slot[around.count++] = static_cast<int8_t>(slot);
      }
    }
    return around;
  }

  static FacetPlane plane_of(const Around& around, const Facet& own) {
    const auto all = [](size_t) { return true; };
    const auto agreeing = [&](size_t k) { return dot(around.facet[k]->direction, own.direction) >= 0; };
    FacetPlane plane;
    if (cells_with(around, all) < fewest_cells) return plane;
    Spread spread = spread_of(around, all);
    plane.filled = spread.variance[1] > least_spread * spread.variance[2];
    bool thin = spread.variance[0] <= most_thick * spread.variance[1];
    const bool thin_far = spread.variance[0] <= most_thick_far * spread.variance[1];
    if (plane.filled && !thin && cells_with(around, agreeing) >= fewest_cells) {
      spread = spread_of(around, agreeing);
      thin = spread.variance[0] <= most_thick * spread.variance[1] &&
             spread.variance[1] > least_spread * spread.variance[2];
    }
    if (!plane.filled) return plane;
    plane.normal = spread.normal;
    plane.thick = spread.variance[0] / spread.variance[1];
    if (!thin) {
      measure_area(around, agreeing, plane);
      return plane;
    }
    plane.found = true;
    plane.found_far = thin_far;
    const float towards = dot(plane.normal, own.direction);
    const bool told = std::abs(towards) > least_incidence * norm(own.direction);
    const auto same_side = [&](size_t k) {
      return !told || dot(plane.normal, around.facet[k]->direction) * towards >= 0;
    };
    measure_area(around, same_side, plane);
    plane.sides = sides_of(around, plane);
    return plane;
  }

  std::span<const Vec3d> positions_;
  std::span<const Vec3f> directions_;
  SampleOrder order_;
  const Parallel& parallel_;
  Progress& progress_;
  std::vector<uint8_t> first_filled_;  ///< depth of each sample's first filled cells; 0: none yet
  std::vector<State> state_;           ///< of each sample
  LocalSurface surface_;
};

}  // namespace

LocalSurface measure_local_surface(std::span<const Vec3d> positions, std::span<const Vec3f> directions,
                                   const Box3d& box, const Parallel& parallel, Progress& progress) {
  return Survey(positions, directions, box, parallel, progress).run();
}

}  // namespace soapfilm
