#include "soapfilm/select/thin_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "soapfilm/core/error.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/grid/smoothing.h"
#include "soapfilm/select/coarse_problem.h"
#include "soapfilm/select/folds.h"

namespace soapfilm {

namespace {

constexpr float inside_above = 0.5f;
/// Fewer samples are too few to be asked in halves.
constexpr size_t fewest_samples = 8 * fewest_held_out;
/// What a sample gains through a flat film across its direction: the middle tap.
constexpr double flux_per_sample = smoothing_taps[smoothing_reach];
constexpr std::array<Vec3i, 6> steps = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

using Sides = DenseField<uint8_t>;  ///< 1 inside
using Labels = DenseField<int32_t>;

template <class T, class Visit>
void for_each_vertex(const DenseField<T>& field, Visit&& visit) {
  const Vec3i lo = field.origin(), hi = lo + field.size();
  for (int z = lo.z; z < hi.z; ++z)
    for (int y = lo.y; y < hi.y; ++y)
      for (int x = lo.x; x < hi.x; ++x) visit(Vec3i{x, y, z});
}

Sides sides_of(const Level& level) {
  Sides sides(level.box);
  BrickMask::whole(level.box.bricks).for_each([&](Vec3i brick) {
    const int32_t n = level.grid.find(brick);
    const float* u = n >= 0 ? level.u.brick(static_cast<size_t>(n)) : nullptr;
    const uint8_t elsewhere = level.inside.test(brick) ? 1 : 0;
    for_each_run(sides, brick, [&](uint8_t* row, int x, int y, int z, int count) {
      for (int i = 0; i < count; ++i) row[i] = u ? (u[brick_offset(x + i, y, z)] > inside_above ? 1 : 0) : elsewhere;
    });
  });
  return sides;
}

bool is_constant_around(const Sides& sides, Vec3i v) {
  const uint8_t own = sides.get(v);
  for (int slot = 0; slot < 27; ++slot)
    if (sides.get(v + slot_offset(slot)) != own) return false;
  return true;
}

/// What the two solutions differ in, away from the usual one's surface: so a surface that merely moved is no part.
struct Lost {
  Labels label;                           ///< part + 1; 0: none
  std::vector<std::vector<Vec3i>> parts;  ///< vertices of each connected part
};

Lost lost_parts(const Sides& usual, const Sides& low, const LevelBox& box) {
  constexpr int32_t unlabelled = -1;
  Lost lost{Labels(box), {}};
  for_each_vertex(usual, [&](Vec3i v) {
    if (usual.at(v) != low.at(v) && is_constant_around(usual, v)) lost.label.at(v) = unlabelled;
  });
  for_each_vertex(usual, [&](Vec3i seed) {
    if (lost.label.at(seed) != unlabelled) return;
    std::vector<Vec3i>& part = lost.parts.emplace_back(std::vector{seed});
    const auto label = static_cast<int32_t>(lost.parts.size());
    lost.label.at(seed) = label;
    for (size_t i = 0; i < part.size(); ++i)
      for (const Vec3i step : steps) {
        const Vec3i next = part[i] + step;
        // What the low film gained and what it emptied are different parts.
        if (lost.label.get(next) != unlabelled || low.at(next) != low.at(seed)) continue;
        lost.label.at(next) = label;
        part.push_back(next);
      }
  });
  return lost;
}

/// Area of the low film beside a vertex, counted on the vertex's side.
float film_area(const Sides& low, Vec3i v) {
  int faces = 0;
  for (const Vec3i step : steps) faces += low.get(v + step) != low.at(v);
  return static_cast<float>(area_per_face * faces);
}

/// Sum of the data term over a part, signed so that flux in favour of the low film is positive.
double flux_of(const SupportField& field, const std::vector<Vec3i>& part, const Sides& low) {
  double sum = 0;
  for (const Vec3i v : part) {
    const int32_t b = field.grid.find(brick_of(v));
    if (b < 0) continue;
    const float f = field.f.brick(static_cast<size_t>(b))[brick_offset(v.x & 7, v.y & 7, v.z & 7)];
    sum += low.at(v) ? f : -f;
  }
  return sum;
}

/// Does a sample at this lattice position lie on a lost part: does the low film pass within 1.5 voxels, look the same
/// way, and bound a lost vertex?
bool lies_on(Vec3d position, Vec3f direction, const Sides& low, const Labels& label) {
  const Vec3i first = Vec3i(position) - Vec3i{1, 1, 1};
  const Vec3d v(direction);
  double outward = 0;
  int inside = 0, found = 0;
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        const Vec3i vertex = first + Vec3i{x, y, z};
        const bool in = low.get(vertex) != 0;
        const double along = dot(Vec3d(vertex) - position, v);
        outward += in ? -along : along;
        inside += in;
        found += label.get(vertex) > 0;
      }
  return found > 0 && inside > 0 && inside < 64 && outward > 0;
}

/// Sums over the cube of `radius` vertices around each vertex.
void sum_around(DenseField<float>& field, int radius, const Parallel& parallel) {
  const Vec3i n = field.size();
  for (int axis = 0; axis < 3; ++axis) {
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    const size_t stride = field.stride(axis);
    parallel.for_each(static_cast<size_t>(n[b]), 1, [&](size_t outer) {
      std::vector<float> line(static_cast<size_t>(n[axis]));
      for (int inner = 0; inner < n[a]; ++inner) {
        float* first = field.data() + outer * field.stride(b) + static_cast<size_t>(inner) * field.stride(a);
        for (int i = 0; i < n[axis]; ++i) line[static_cast<size_t>(i)] = first[static_cast<size_t>(i) * stride];
        for (int i = 0; i < n[axis]; ++i) {
          float sum = 0;
          for (int j = std::max(0, i - radius); j <= std::min(n[axis] - 1, i + radius); ++j)
            sum += line[static_cast<size_t>(j)];
          first[static_cast<size_t>(i) * stride] = sum;
        }
      }
    });
  }
}

/// The probe's question and its answers.
struct Probe {
  const PointCloud& cloud;
  std::span<const Vec3f> directions;
  const Lattice& lattice;
  double density;  ///< samples per voxel^2 of surface, voxels of the probe's lattice
  const Parallel& parallel;
};

/// The data term of one fold.
SupportField field_of(const Probe& probe, const Folds& folds, int fold) {
  const auto in_fold = [&](size_t i) { return folds.of_sample[i] == fold; };
  return divergence_field(sort_samples(probe.cloud, probe.directions, probe.lattice, probe.parallel, in_fold),
                          probe.lattice.box(0), probe.parallel);
}

/// The lost parts that the held-out samples confirm and that are thin; the others lose their labels.
std::vector<ThinPart> confirmed(const Sides& low, const SupportField& trained, const SupportField& held_out,
                                double held_out_per_trained, double density, const ThinPartsParams& params,
                                Lost& lost) {
  std::vector<ThinPart> found;
  for (const std::vector<Vec3i>& part : lost.parts) {
    double area = 0;
    for (const Vec3i v : part) area += film_area(low, v);
    const double of_trained = flux_of(trained, part, low), of_held_out = flux_of(held_out, part, low);
    const double samples = (of_trained + of_held_out) / flux_per_sample;
    const ThinPart thin{samples, samples / (area * density), of_held_out / (held_out_per_trained * of_trained)};
    const bool confirmed = of_held_out >= params.least_samples * flux_per_sample && thin.agreement >= params.agreement;
    if (confirmed && thin.density * params.thinness <= 1)
      found.push_back(thin);
    else
      for (const Vec3i v : part) lost.label.at(v) = 0;
  }
  return found;
}

/// By the density of the samples on lost parts around each of them, against the mean one.
std::vector<float> weights_on(const Probe& probe, const Lost& lost, const Sides& low, double most_weight) {
  constexpr int radius = 4;  // voxels around a sample
  const auto lattice_position = [&](size_t i) { return probe.lattice.to_lattice(probe.cloud.positions[i]); };
  const auto direction = [&](size_t i) { return probe.lattice.from_world_axes(probe.directions[i]); };
  const auto nearest = [&](size_t i) { return Vec3i(lattice_position(i) + Vec3d{0.5, 0.5, 0.5}); };
  std::vector<uint8_t> on_part(probe.cloud.size());
  probe.parallel.for_each(on_part.size(), 4096, [&](size_t i) {
    on_part[i] =
        speaks(probe.cloud, probe.directions, i) && lies_on(lattice_position(i), direction(i), low, lost.label);
  });

  DenseField<float> count(probe.lattice.box(0)), area(probe.lattice.box(0));
  for (size_t i = 0; i < on_part.size(); ++i)
    if (on_part[i]) count.at(nearest(i)) += 1;
  for_each_vertex(area, [&](Vec3i v) {
    if (lost.label.at(v) > 0) area.at(v) = film_area(low, v);
  });
  sum_around(count, radius, probe.parallel);
  sum_around(area, radius, probe.parallel);

  std::vector<float> weights(on_part.size(), 1.0f);
  for (size_t i = 0; i < on_part.size(); ++i) {
    if (!on_part[i]) continue;
    const Vec3i v = nearest(i);
    const double local = count.at(v) / std::max(1.0f, area.at(v));
    weights[i] = static_cast<float>(std::clamp(probe.density / local, 1.0, most_weight));
  }
  return weights;
}

}  // namespace

std::vector<float> weigh_thin_parts(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& finest,
                                    const Sampling& sampling, double lambda_per_density, const ThinPartsParams& params,
                                    const PrimalDualParams& solver, const Parallel& parallel, Progress& progress,
                                    ThinPartsReport& report) {
  const Lattice lattice = coarse_lattice(cloud, finest, params.max_resolution, parallel);
  report.grid = lattice.to_world_axes(lattice.size);
  report.voxel = lattice.voxel;
  size_t speaking = 0;
  for (size_t i = 0; i < cloud.size(); ++i) speaking += speaks(cloud, directions, i);
  if (speaking < fewest_samples) return {};

  const Probe probe{cloud, directions, lattice, sampling.density(lattice.voxel), parallel};
  const Folds folds = make_folds(cloud, directions, 2, FoldSource::samples, params.seed);
  const double share = static_cast<double>(folds.sizes[0]) / static_cast<double>(speaking);
  const double lambda = lambda_per_density * probe.density * share;
  const SupportField trained = field_of(probe, folds, 0);
  const Sides usual = sides_of(solve_coarse(lattice, trained, lambda, solver, parallel).finest);
  progress.check();
  const Sides low = sides_of(solve_coarse(lattice, trained, params.lambda_ratio * lambda, solver, parallel).finest);
  progress.check();
  Lost lost = lost_parts(usual, low, lattice.box(0));
  if (lost.parts.empty()) return {};

  report.parts = confirmed(low, trained, field_of(probe, folds, 1), (1 - share) / share, probe.density, params, lost);
  if (report.parts.empty()) return {};
  std::vector<float> weights = weights_on(probe, lost, low, params.most_weight);
  for (const float weight : weights)
    if (weight > 1) {
      ++report.samples;
      report.mean_weight += weight;
    }
  if (report.samples > 0) report.mean_weight /= static_cast<double>(report.samples);
  return weights;
}

void validate(const ThinPartsParams& params) {
  const auto require = [](bool holds, const char* name, double value, const char* constraint) {
    if (!holds) throw ParameterError(fmt::format("{} = {:g}, must be {}", name, value, constraint));
  };
  require(params.max_resolution >= 32 && params.max_resolution <= 512, "max_resolution", params.max_resolution,
          "between 32 and 512");
  require(params.lambda_ratio > 0 && params.lambda_ratio < 1, "lambda_ratio", params.lambda_ratio, "> 0 and < 1");
  require(params.thinness >= 1, "thinness", params.thinness, ">= 1");
  require(params.agreement > 0 && params.agreement < 1, "agreement", params.agreement, "> 0 and < 1");
  require(params.least_samples > 0, "least_samples", params.least_samples, "> 0");
  require(params.most_weight >= 1, "most_weight", params.most_weight, ">= 1");
}

}  // namespace soapfilm
