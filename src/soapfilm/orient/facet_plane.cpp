#include "soapfilm/orient/facet_plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>

#include "soapfilm/core/portable_math.h"

namespace soapfilm {

namespace {

constexpr int fewest_cells = 6;           // of 27: a plane passes through 9 to 13
constexpr double least_spread = 0.15;     // middle over largest variance: below it the samples lie along a line
constexpr double most_thick = 0.08;       // least over middle variance of a plane
constexpr double most_thick_far = 0.04;   // the same in cells larger than the first ones that are filled
constexpr double least_incidence = 0.05;  // cosine of direction and normal, below which the side is unknown
constexpr double least_agreement = 0.75;  // length of the mean direction; random ones on one side have a half
constexpr double most_outward = 0.3;      // of a plane, see FacetPlane::outward
constexpr double least_outward = 0.45;    // of an edge or a rod; six outliers rarely reach it by chance
constexpr double most_outnumbered = 8;    // by samples seen from the other side; with more, the samples are outliers
constexpr double few_others = 0.1;        // of the other side, so few that differing directions do not matter
constexpr double parts_per_face = 16;     // number of a cell's parts that a plane along its face meets
// Limits for a plane that confirms another one.
constexpr double most_thick_again = 0.35;
constexpr double least_agreement_again = 0.65;
/// An edge, a rod: there the directions must agree even better at the next depth, as directions to one scanner do.
constexpr double least_agreement_of_edges = 0.9, least_outward_again = 0.4;
constexpr float least_along_again = 0.65f;  // cosine of the normals

struct Spread {
  Eigen::Vector3d variance;
  Vec3f normal;
};

template <class Wanted>
Spread spread_of(const FacetsAround& around, Wanted&& wanted) {
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
int cells_with(const FacetsAround& around, Wanted&& wanted) {
  uint32_t cells = 0;
  for (size_t k = 0; k < around.count; ++k)
    if (wanted(k)) cells |= 1u << around.slot[k];
  return std::popcount(cells);
}

/// Mean of a Poisson distribution whose mean without zeros is `seen` >= 1 (Newton's method from above).
double mean_with_zeros(double seen) {
  double mean = seen;
  for (int k = 0; k < 8; ++k) {
    const double e = portable_exp(-mean);
    const double value = mean - seen * (1 - e), slope = 1 - seen * e;
    if (slope <= 0.05 || value < 1e-3 * mean) break;
    mean = std::max(mean - value / slope, 0.05);
  }
  return mean;
}

/// Area of a plane inside the 27 cells, cells^2; it passes through the middle of the wanted facets.
template <class Wanted>
double block_area(const FacetsAround& around, Wanted&& wanted, Vec3f n) {
  Vec3f middle{};
  float count = 0;
  for (size_t k = 0; k < around.count; ++k) {
    if (!wanted(k)) continue;
    middle = middle + around.mean[k];
    ++count;
  }
  const float offset = dot(n, middle) / count;
  // On a raster of the coordinate plane to which it is most nearly parallel.
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

/// For the samples on its own side: area per sample and spacing of different ones, in cells. A plane meets |n_x| +
/// |n_y| + |n_z| cells per cell^2 of its area.
template <class Wanted>
void measure_area(const FacetsAround& around, Wanted&& wanted, FacetPlane& plane) {
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
  // Parts shared by several samples count once: estimates the number if each had a part of its own.
  const double parts = parts_per_face * cells;
  const double apart = -parts * portable_log1p(-std::min(distinct / parts, 0.95));
  const double in_cell = mean_with_zeros(std::max(apart / cells, 1.0 + 1e-3));
  // Cells, including those without samples; but no more than the plane passes through (samples in a raster miss none).
  // Cells of which a plane cuts only corners are missed more often: how often was measured on spheres, planes, rasters
  // and lines of samples, whose areas are found within 17 %.
  const double at_most = std::max<double>(cells, per_area * block_area(around, wanted, n));
  const double met = std::min(apart / in_cell, at_most) * (1.05 + 0.47 * (per_area - 1));
  plane.area = static_cast<float>(met / per_area / samples);
  plane.spacing = static_cast<float>(std::sqrt(met / per_area / apart));
}

/// Computes FacetPlane::outward.
double outward_of(const FacetsAround& around) {
  Vec3f middle{};
  for (size_t k = 0; k < around.count; ++k) middle += around.mean[k];
  middle = middle * (1 / static_cast<float>(around.count));
  double sum = 0, all = 0;
  for (size_t k = 0; k < around.count; ++k) {
    const Vec3f from_middle = around.mean[k] - middle, direction = around.facet[k]->direction;
    const float length = norm(direction);
    if (!(length > 0)) continue;
    sum += dot(direction, from_middle) / length;
    all += norm(from_middle);
  }
  return all > 0 ? sum / all : 0;
}

LocalSides sides_of(const FacetsAround& around, const FacetPlane& plane) {
  LocalSidesBuilder sides;
  for (size_t k = 0; k < around.count; ++k) {
    const Facet& facet = *around.facet[k];
    sides.add(around.slot[k], facet.count, dot(facet.direction, plane.normal), dot(around.mean[k], plane.normal));
  }
  return sides.result(plane.spacing);
}

}  // namespace

bool FacetPlane::agrees() const {
  return agreement >= least_agreement || (found ? one_sided : outward >= least_outward);
}

bool FacetPlane::confirms_edge() const {
  return agreement >= least_agreement_of_edges || outward >= least_outward_again;
}

bool FacetPlane::confirms(Vec3f normal_before) const {
  return thick <= most_thick_again && (agreement >= least_agreement_again || one_sided) &&
         std::abs(dot(normal, normal_before)) >= least_along_again;
}

FacetsAround measure_surroundings(const SampleCells& cells, size_t c) {
  FacetsAround around;
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

FacetPlane plane_of(const FacetsAround& around, const Facet& own) {
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
    thin =
        spread.variance[0] <= most_thick * spread.variance[1] && spread.variance[1] > least_spread * spread.variance[2];
  }
  if (!plane.filled) return plane;
  plane.normal = spread.normal;
  plane.thick = spread.variance[0] / spread.variance[1];
  plane.outward = outward_of(around);
  if (!thin || plane.outward >= most_outward) {
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

}  // namespace soapfilm
