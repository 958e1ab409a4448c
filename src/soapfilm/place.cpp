#include "soapfilm/place.h"
#include "soapfilm/core/parallel.h"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>

#include "soapfilm/core/error.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/field/sampling.h"
#include "soapfilm/orient/area_weights.h"

namespace soapfilm {

namespace {

/// Sides of the samples' box, input units, whose squares and cubes double can hold.
constexpr double shortest_box = 1e-100, longest_box = 1e100;
/// Fewer samples cannot lie around a volume.
constexpr size_t fewest_samples = 4;
/// Thickness of the samples along their thinnest direction, relative to the longest, below which they are coplanar.
constexpr double coplanar = 1e-7;
/// Thickness of sheets that a grid holds with hardly a sample on the wrong side, voxels; and the share of the area from
/// which on they count.
constexpr double held_well = 1.4, notable_sheets = 0.1;
constexpr size_t samples_per_task = size_t{1} << 15;

/// Two sides of a sheet that are hardly a voxel apart blur into each other: the voxel follows the sheets' thickness if
/// they are a notable part of the surface, as far as their samples can tell their sides apart.
double voxel_of_sheets(double voxel, const SideTally& sides, const Box3d& box) {
  constexpr double finest = 0.65;  // of what the spacing tells
  const SideTally::Thin sheets = sides.thinner_than(held_well * voxel / box.longest());
  if (sheets.share < notable_sheets || sides.contradicts()) return voxel;
  return std::clamp(sheets.thickness * box.longest() / held_well, finest * voxel, voxel);
}

double choose_voxel(const PlaceParams& params, const Box3d& box, const Sampling& sampling,
                    const LocalSurface& surface) {
  if (params.voxel) {
    if (*params.voxel <= box.longest()) return *params.voxel;
    throw ParameterError(fmt::format("voxel = {:g}, must be <= {:.6g}, the longest side of the samples' box",
                                     *params.voxel, box.longest()));
  }
  if (params.resolution) return voxel_of_resolution(box, *params.resolution, params.padding);
  const double voxel = surface.coverage.area > 0 ? surface.coverage.spacing * std::sqrt(params.samples_per_voxel2)
                                                 : sampling.voxel(params.samples_per_voxel2);
  if (voxel > 0) return voxel_of_sheets(voxel, surface.sides, box);
  // Too few samples to measure their density: as coarse as the pyramid allows.
  constexpr int fallback_resolution = 64;
  return voxel_of_resolution(box, fallback_resolution, params.padding);
}

/// Sums over positions.
struct Moments {
  Vec3d sum, squares, products;

  void add(Vec3d q) {
    sum += q;
    squares += Vec3d{q.x * q.x, q.y * q.y, q.z * q.z};
    products += Vec3d{q.x * q.y, q.y * q.z, q.z * q.x};
  }
  Moments& operator+=(const Moments& o) {
    sum += o.sum, squares += o.squares, products += o.products;
    return *this;
  }
};

/// Whether a sample counts by the area that it stands for; where lambda is given, it is the paper's: against one vector
/// for each sample.
bool weighs_by_area(const ReconstructParams& params) {
  return params.method != Method::vrip && params.energy.by_area && !params.energy.lambda;
}

void warn_near_empty(double lambda, double density, std::vector<std::string>& warnings) {
  const double edge = critical_density * density;
  if (3 * lambda > edge)
    warnings.push_back(
        fmt::format("lambda = {:.3g} is {} {:.3g}, above which a film over {:.2g} samples per voxel^2 "
                    "vanishes: expect missing parts (smaller --lambda, or coarser voxels)",
                    lambda, lambda > edge ? "above" : "near", edge, density));
}

/// Many samples at one place are more often a camera's way to say "nothing" than a surface.
void warn_of_repeats(const Sampling& sampling, size_t samples, std::vector<std::string>& warnings) {
  if (sampling.repeats == 0) return;
  const Vec3d& at = sampling.most_repeated;
  warnings.push_back(
      fmt::format("{} of {} samples are where another one is, most at ({:g}, {:g}, {:g}): pixels without "
                  "depth? Their density counts each place once",
                  sampling.repeats, samples, at.x, at.y, at.z));
}

/// Sides of a sheet less than a voxel apart run into each other: measured on a bent sheet, 6 % of the samples see the
/// wrong side at 0.7 voxels, 26 % at 0.5; 0.3 % at 1.0, and none at 1.4.
void warn_of_thin_sheets(const SideTally& sides, double longest, double voxel, std::vector<std::string>& warnings) {
  constexpr double held = 0.9;  // voxels
  const SideTally::Thin thin = sides.thinner_than(held * voxel / longest);
  if (thin.share < notable_sheets || sides.contradicts()) return;
  const double thickness = thin.thickness * longest;
  warnings.push_back(
      fmt::format("{:.0f} % of the area lies on sheets thinner than a voxel can hold, half of it about {:.2g} thick or "
                  "less: their two sides may run into each other; try --voxel {:.2g}",
                  100 * thin.share, thickness, thickness / held_well));
}

/// Beyond the end of the curve something better may lie.
void warn_at_end(const CrossValidationReport& select, std::vector<std::string>& warnings) {
  const double lowest = select.curve.front().lambda_per_density, highest = select.curve.back().lambda_per_density;
  if (lowest == highest || (select.chosen != lowest && select.chosen != highest)) return;
  const bool low = select.chosen == lowest;
  warnings.push_back(
      fmt::format("cross-validation chose the {} of {} candidates, {:g} x samples per voxel^2: a {} one may be better",
                  low ? "lowest" : "highest", select.curve.size(), select.chosen, low ? "lower" : "higher"));
}

}  // namespace

Box3d check_samples(const PointCloud& cloud, const Context& context) {
  if (cloud.size() < fewest_samples)
    throw SamplesError(
        fmt::format("{} sample{}, must be at least {}", cloud.size(), cloud.size() == 1 ? "" : "s", fewest_samples));
  if (cloud.size() > most_samples)
    throw SamplesError(fmt::format("{} samples, must be at most {}", cloud.size(), most_samples));
  const auto box_of = [&](size_t begin, size_t end) {
    Box3d box;
    for (size_t i = begin; i < end; ++i) {
      if (!is_finite(cloud.positions[i])) throw SamplesError(fmt::format("sample {}: position is not finite", i));
      box.extend(cloud.positions[i]);
    }
    return box;
  };
  const auto box = join_chunks<Box3d>(cloud.size(), samples_per_task, context, box_of,
                                      [](Box3d& whole, const Box3d& part) { whole.extend(part); });
  if (!(box.longest() > 0))
    throw SamplesError(fmt::format("all {} samples are identical, must span a volume", cloud.size()));
  if (box.longest() < shortest_box || box.longest() > longest_box)
    throw SamplesError(fmt::format("the longest side of the samples' box = {:g}, must be in [{:g}, {:g}]",
                                   box.longest(), shortest_box, longest_box));

  const Vec3d centre = box.centre();
  const double scale = 1 / box.longest();
  const auto [sum, squares, products] =
      sum_chunks<Moments>(cloud.size(), samples_per_task, context, [&](size_t begin, size_t end) {
        Moments moments;
        for (size_t i = begin; i < end; ++i) moments.add((cloud.positions[i] - centre) * scale);
        return moments;
      });
  Eigen::Vector3d mean(sum.x, sum.y, sum.z);
  Eigen::Matrix3d moments;
  moments << squares.x, products.x, products.z, products.x, squares.y, products.y, products.z, products.y, squares.z;
  const auto n = static_cast<double>(cloud.size());
  mean /= n;
  const Eigen::Matrix3d covariance = moments / n - mean * mean.transpose();
  const Eigen::Vector3d variance = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues();
  // In units of the longest side; variances below double's rounding of 1 are no thickness.
  if (variance[0] <= std::max(coplanar * coplanar * variance[2], 1e-15))
    throw SamplesError(
        fmt::format("all {} samples are coplanar (but for {:g} of their longest side, {:.6g}), must span a volume",
                    cloud.size(), coplanar, box.longest()));
  return box;
}

Room check_room(const PointCloud& cloud, const ReconstructParams& params) {
  const Room room(params.memory_limit, held_memory_bytes());
  check_placing(plan_placing(cloud), room, cloud.size());
  return room;
}

GridSamples place(const PointCloud& cloud, const Box3d& box, std::span<const Vec3f> directions,
                  const LocalSurface& surface, const ReconstructParams& params, const Room& room,
                  const Context& context, ReconstructReport& report) {
  const Sampling sampling = measure_sampling(cloud, box, context);
  const AreaCoverage& coverage = surface.coverage;
  const double voxel = choose_voxel(params.place, box, sampling, surface);
  const bool by_resolution = params.place.resolution && !params.place.voxel;
  try {
    report.lattice = place_lattice(box, voxel, params.place.padding, params.place.levels);
    const double density = sampling.density(voxel);
    const MemoryPlan tables = plan_tables(params.method, report.lattice);
    check_memory(tables, tables.total(), room, report.lattice,
                 density > 0 ? static_cast<double>(cloud.size()) / density : 0, by_resolution);
  } catch (const MemoryError& error) {
    throw MemoryError(error.what() + far_samples(cloud, box));
  } catch (const ParameterError& error) {
    throw ParameterError(error.what() + far_samples(cloud, box));
  }
  report.input.samples = cloud.size();
  report.input.scans = cloud.scans.size();
  report.input.box = box;
  report.input.density =
      weighs_by_area(params) && coverage.area > 0 ? coverage.per_area * voxel * voxel : sampling.density(voxel);
  warn_of_repeats(sampling, cloud.size(), report.warnings);
  warn_of_thin_sheets(surface.sides, box.longest(), voxel, report.warnings);

  GridSamples samples = sort_samples(cloud, directions, report.lattice, context);
  if (samples.size() == 0) throw SamplesError(fmt::format("none of the {} samples has a direction", cloud.size()));
  return samples;
}

void weigh_area(const PointCloud& cloud, std::span<const Vec3f> directions, const LocalSurface& surface,
                const ReconstructParams& params, const Context& context, GridSamples& samples,
                ReconstructReport& report) {
  double per_density = params.energy.lambda_per_density;
  if (params.energy.cross_validate) {
    report.select = choose_lambda(cloud, directions, report.lattice, params.select, params.solve, context);
    per_density = report.select->chosen;
    // The same rule on this grid, by the density that counts here.
    for (CrossValidationPoint& point : report.select->curve)
      point.lambda = point.lambda_per_density * report.input.density;
    warn_at_end(*report.select, report.warnings);
  }
  const double lambda = params.energy.lambda.value_or(per_density * report.input.density);
  if (!(lambda > 0)) throw SamplesError("too few samples to measure their density by: lambda must be given");
  report.certificate.lambda = lambda;
  if (weighs_area(params.method)) warn_near_empty(lambda, report.input.density, report.warnings);
  if (!weighs_by_area(params)) return;
  constexpr double most_weight = 50;
  const std::vector<float> weights = weigh_by_area(surface, most_weight, context);
  parallel_for(context, samples.size(), samples_per_task,
               [&](size_t k) { samples.direction[k] = samples.direction[k] * weights[samples.source[k]]; });
}

}  // namespace soapfilm
