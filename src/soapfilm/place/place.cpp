#include "soapfilm/place/place.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "soapfilm/core/farthest.h"
#include "soapfilm/error.h"
#include "soapfilm/field/noise.h"
#include "soapfilm/field/sampling.h"

namespace soapfilm {

namespace {

/// Thickness of sheets, voxels, at which a grid puts almost no sample on the wrong side; and the share of the area at
/// which thin sheets matter.
constexpr double held_well = 1.4, notable_sheets = 0.1;

/// Two sides of a sheet that are barely a voxel apart merge: the voxel follows the sheets' thickness if they are a
/// notable part of the surface, as far as their samples determine the side.
double voxel_of_sheets(double voxel, const SideStatistics& sides, const Box3d& box) {
  constexpr double finest = 0.65;  // smallest factor on the voxel that follows from the spacing
  const SideStatistics::Thin sheets = sides.thinner_than(held_well * voxel / box.longest());
  if (sheets.share < notable_sheets || sides.contradicts()) return voxel;
  return std::clamp(sheets.thickness * box.longest() / held_well, finest * voxel, voxel);
}

double voxel_as_given(const PlaceParams& params, const Box3d& box) {
  if (params.resolution) return voxel_of_resolution(box, *params.resolution, params.padding);
  if (*params.voxel <= box.longest()) return *params.voxel;
  throw ParameterError(fmt::format("voxel = {:g}, must be <= {:.6g}, the longest side of the samples' box",
                                   *params.voxel, box.longest()));
}

/// Samples that far apart are lone points to the grid: nothing joins them, and each is paid for by itself.
void refuse_too_fine(const PlaceParams& params, const Box3d& box, double voxel, double density) {
  constexpr double most_apart = 100;  // voxels
  if (!(density > 0) || density * most_apart * most_apart >= 1) return;
  const double spacing = voxel / std::sqrt(density), least = spacing / most_apart;
  const std::string given = params.resolution && !params.voxel
                                ? fmt::format("resolution = {}, must be at most {:.0f}", *params.resolution,
                                              std::floor(box.longest() / least) + 2 * params.padding)
                                : fmt::format("voxel = {:.4g}, must be at least {:.3g}", voxel, least);
  throw ParameterError(
      fmt::format("{}, {:g} voxels between samples: they are about {:.3g} apart", given, most_apart, spacing));
}

double voxel_of_spacing(const PlaceParams& params, const Box3d& box, const Sampling& sampling,
                        const LocalSurface& surface) {
  const double voxel = surface.coverage.area > 0 ? surface.coverage.spacing * std::sqrt(params.samples_per_voxel2)
                                                 : sampling.voxel(params.samples_per_voxel2);
  if (voxel > 0) return voxel_of_sheets(voxel, surface.sides, box);
  // Too few samples to measure their density: as coarse as the pyramid allows.
  constexpr int fallback_resolution = 64;
  return voxel_of_resolution(box, fallback_resolution, params.padding);
}

/// Far from the origin vertices would be rounded onto each other: triangles without an area.
void refuse_too_far(const Box3d& box, double voxel) {
  constexpr double steps = 65536;  // of rounding, at least, to a voxel
  const double farthest = farthest_coordinate(box);
  const double step = std::numeric_limits<double>::epsilon() * farthest;
  if (voxel < steps * step)
    throw SamplesError(
        fmt::format("voxel = {:g}, must be at least {:g} at coordinates up to {:g}, which are known to {:.1g} only: "
                    "move the samples nearer to the origin",
                    voxel, steps * step, farthest, step));
}

/// Many samples at one place are more often a camera's code for missing depth than a surface.
void warn_of_repeats(const Sampling& sampling, size_t samples, std::vector<std::string>& warnings) {
  if (sampling.repeats == 0) return;
  const Vec3d& at = sampling.most_repeated;
  warnings.push_back(
      fmt::format("{} of {} samples are where another one is, most at ({:g}, {:g}, {:g}): pixels without "
                  "depth? Their density counts each place once",
                  sampling.repeats, samples, at.x, at.y, at.z));
}

/// Sides of a sheet less than a voxel apart merge: measured on a curved sheet, 6 % of the samples see the wrong side at
/// 0.7 voxels, 26 % at 0.5; 0.3 % at 1.0, and none at 1.4.
void warn_of_thin_sheets(const SideStatistics& sides, double longest, double voxel,
                         std::vector<std::string>& warnings) {
  constexpr double held = 0.9;  // voxels
  const SideStatistics::Thin thin = sides.thinner_than(held * voxel / longest);
  if (thin.share < notable_sheets || sides.contradicts()) return;
  const double thickness = thin.thickness * longest;
  warnings.push_back(
      fmt::format("{:.0f} % of the area lies on sheets thinner than a voxel can hold, half of it about {:.2g} thick or "
                  "less: their two sides may run into each other; try --voxel {:.2g}",
                  100 * thin.share, thickness, thickness / held_well));
}

/// Would a surface across the box have far more voxels than there are samples? With even samples there are about as
/// many; a thin rod, a scan that thins out with the distance or a few outliers far away change this some 50 times.
bool is_far_too_fine(double voxel, const Box3d& box, size_t samples) {
  constexpr double far_more = 256;
  const double across = box.longest() / voxel;
  return voxel > 0 && across * across > far_more * static_cast<double>(samples);
}

/// The sampling away from clusters of nearly coinciding samples, where these made the voxel useless: then the surface
/// elsewhere has less than a 64th of a sample per voxel^2, and is lost in any case. Nothing otherwise.
std::optional<ThinnedSampling> sampling_beside_clusters(const PointCloud& cloud, const Box3d& box,
                                                        const PlaceParams& params, double voxel,
                                                        const Context& context) {
  // Where many of the kept samples stand for several, each may be an object of its own, and its samples a surface.
  constexpr double much_wider = 8, wider_than_objects = 256, most_crowded = 0.25;
  if (!is_far_too_fine(voxel, box, cloud.size())) return {};
  ThinnedSampling thinned = measure_thinned(cloud, box, context);
  const double wider = thinned.crowded < most_crowded ? much_wider : wider_than_objects;
  if (thinned.sampling.voxel(params.samples_per_voxel2) < wider * voxel) return {};
  return thinned;
}

std::string about_clusters(const ThinnedSampling& thinned, double voxel, bool is_given) {
  const auto crowded = std::count_if(thinned.weights.begin(), thinned.weights.end(), [](float w) { return w < 0.25f; });
  return fmt::format(
      "{} of {} samples nearly coincide with many others: their spacing asks for a voxel of {:.3g}, {}; "
      "those at one place count as one",
      crowded, thinned.weights.size(), voxel,
      is_given ? "the others' for a coarser one" : "the others' is used instead (--voxel sets it)");
}

/// The spacing, input units, below which the samples of so much of the area are; 0: unknown.
double dense_spacing(const std::vector<float>& spacings, double share) {
  std::vector<float> known;
  for (const float s : spacings)
    if (s > 0) known.push_back(s);
  std::sort(known.begin(), known.end());
  double area = 0, all = 0;
  for (const float s : known) all += static_cast<double>(s) * s;
  for (const float s : known)
    if ((area += static_cast<double>(s) * s) >= share * all) return s;
  return 0;
}

/// Levels below a voxel, as many as dense samples and their noise allow: the finest voxel is about their spacing.
int levels_below(double voxel, const LocalSurface& surface, double noise) {
  constexpr double dense_share = 0.05;  // of the area
  constexpr int most = 2;               // at each more level the finest voxels are four times as many
  const double spacing = std::max(dense_spacing(surface.spacing, dense_share), default_voxel_over_noise * noise);
  return spacing > 0 ? std::clamp(static_cast<int>(std::lround(std::log2(voxel / spacing))), 0, most) : 0;
}

/// Levels that a voxel as given has below the one that would be chosen.
int levels_below(double voxel, double chosen) {
  constexpr int most = 6;
  return std::clamp(static_cast<int>(std::lround(std::log2(chosen / voxel))), 0, most);
}

}  // namespace

Grid place_grid(const PointCloud& cloud, const Box3d& box, const Seen& seen, const PlaceParams& params, bool by_area,
                const Context& context) {
  const LocalSurface& surface = seen.surface;
  const Sampling sampling = measure_sampling(cloud, box, context);
  const AreaCoverage& coverage = surface.coverage;
  Grid grid;
  grid.default_voxel = voxel_of_spacing(params, box, sampling, surface);
  const bool is_given = params.voxel || params.resolution;
  std::optional<ThinnedSampling> thinned = sampling_beside_clusters(cloud, box, params, grid.default_voxel, context);
  if (thinned) {
    grid.warnings.push_back(about_clusters(*thinned, grid.default_voxel, is_given));
    grid.default_voxel = thinned->sampling.voxel(params.samples_per_voxel2);
    grid.weights = std::move(thinned->weights);
  }
  if (!seen.from_above) grid.noise = measure_noise(cloud.positions, seen.directions, context);
  if (const double by_noise = default_voxel_over_noise * grid.noise;
      by_noise > grid.default_voxel && by_noise < box.longest() / 8) {
    grid.default_voxel = by_noise;
    grid.voxel_by_noise = !is_given;
  }
  double voxel = is_given ? voxel_as_given(params, box) : grid.default_voxel;
  if (params.adapt && !params.anchor && !surface.spacing.empty()) {
    grid.finer = is_given ? levels_below(voxel, grid.default_voxel) : levels_below(voxel, surface, grid.noise);
    if (is_given) voxel = std::ldexp(voxel, grid.finer);
  }
  try {
    grid.lattice = place_lattice(box, voxel, params.padding, params.levels, params.anchor);
  } catch (const ParameterError& error) {
    throw ParameterError(error.what() + far_samples(cloud, box));
  }
  refuse_too_far(box, voxel);
  const double density = (thinned ? thinned->sampling : sampling).density(voxel);
  grid.density = !thinned && by_area && coverage.area > 0 ? coverage.per_area * voxel * voxel : density;
  if (is_given) refuse_too_fine(params, box, voxel, density);
  grid.area = density > 0 ? static_cast<double>(cloud.size()) / density : 0;
  warn_of_repeats(sampling, cloud.size(), grid.warnings);
  warn_of_thin_sheets(surface.sides, box.longest(), voxel, grid.warnings);
  return grid;
}

std::string far_samples(const PointCloud& cloud, const Box3d& box) {
  const size_t few = std::max<size_t>(1, cloud.size() / 2000);  // from each end of each axis
  if (2 * few >= cloud.size()) return {};
  Box3d most = box;
  Vec3d farthest = box.lo;
  double distance = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along(cloud.size());
    for (size_t i = 0; i < along.size(); ++i) along[i] = cloud.positions[i][axis];
    const auto low = along.begin() + static_cast<std::ptrdiff_t>(few), high = along.end() - 1 - (low - along.begin());
    std::nth_element(along.begin(), low, along.end());
    most.lo[axis] = *low;
    std::nth_element(along.begin(), high, along.end());
    most.hi[axis] = *high;
  }
  if (2 * most.longest() > box.longest()) return {};
  for (const Vec3d& p : cloud.positions)
    for (int axis = 0; axis < 3; ++axis)
      if (const double d = std::max(most.lo[axis] - p[axis], p[axis] - most.hi[axis]); d > distance)
        distance = d, farthest = p;
  const Vec3d all = box.size(), without = most.size();
  return fmt::format(
      " (few of the samples lie far away, one at ({:.6g}, {:.6g}, {:.6g}): without them the box is {:.3g} x {:.3g} x "
      "{:.3g}, not {:.3g} x {:.3g} x {:.3g})",
      farthest.x, farthest.y, farthest.z, without.x, without.y, without.z, all.x, all.y, all.z);
}

}  // namespace soapfilm
