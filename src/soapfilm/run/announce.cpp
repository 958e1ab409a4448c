#include "soapfilm/run/announce.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <utility>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/method.h"
#include "soapfilm/core/names.h"
#include "soapfilm/finish/self_check.h"

namespace soapfilm {

namespace {

void warn_unproved(const GraphCutReport& cut, Method method, Trace& trace) {
  if (!cut.globally_optimal)
    trace.warn(fmt::format(
        "{}: labels at the band's boundary disagree, the cut is not proved to be the global minimum of its energy",
        name_of(method)));
}

}  // namespace

void announce_grid(const Grid& grid, const MemoryBudget& memory, Trace& trace) {
  const Vec3i n = grid.lattice.to_world_axes(grid.lattice.size);
  const std::string by_noise =
      grid.voxel_by_noise ? fmt::format(" by the samples' noise, {:.2g}", grid.noise) : std::string();
  trace.info(fmt::format("grid {} x {} x {}, voxel {:.4g}{}, {:.2g} samples per voxel^2, memory {}", n.x, n.y, n.z,
                         grid.lattice.voxel, by_noise, grid.density, memory.summary()));
  trace.warn(grid.warnings);
}

void announce_lambda(const Lambda& lambda, const Grid& grid, const ReconstructParams& params, Trace& trace) {
  if (uses_lambda(params.method)) trace.info(fmt::format("lambda {:.3g}", lambda.value));
  trace.warn(lambda.warnings);
  if (!uses_lambda(params.method)) return;
  if (std::optional<std::string> warning = near_empty(lambda.value, grid.density)) trace.warn(std::move(*warning));
}

void announce_border(const BorderReport& border, bool inward, Trace& trace) {
  if (!border.reason.empty())  // empty for methods with only one border
    trace.info(fmt::format("outside: {}, {}", name_of(border.chosen), border.reason));
  if (border.turned)
    trace.warn(
        "the normals point into a closed body: all are turned over; if it is a hollow seen from inside, give "
        "--outside solid");
  else if (inward && border.chosen == Border::air)
    trace.warn(
        "most normals point towards the middle of the samples, as those of a room seen from inside do: reverse "
        "them, or try --outside solid");
}

void warn_unconverged(const SolveReport& report, double lambda, const ReconstructParams& params, Trace& trace) {
  const auto warn_level = [&](int level, int iterations, double tolerance) {
    trace.warn(
        fmt::format("level {}: not converged after {} iterations (tolerance {:g}); the certificate below still "
                    "holds",
                    level, iterations, tolerance));
  };
  for (const LevelReport& level : report.levels) {
    if (level.lambda_share < 1) continue;
    // A level whose labels have settled is good enough for the mesh. A coarser one that stalls is only the start of
    // others.
    if (level.stop == Stop::limit) warn_level(level.level, level.iterations, level.tolerance);
    if (level.stop == Stop::stalled && level.level == 0)
      trace.warn(fmt::format(
          "level 0: the gap has stayed at {:.2g} (tolerance {:g}) and more iterations would not help: likely "
          "a large part without samples; the certificate below still holds, --resolution or "
          "--lambda may change it",
          level.energies.relative_gap_band(lambda), level.tolerance));
  }
  for (const SorLevelReport& level : report.sor)
    if (!level.converged) warn_level(level.level, level.iterations, params.sor.tolerance);
  if (report.poisson && !report.poisson->converged)
    trace.warn(fmt::format("poisson: not converged after {} iterations, relative residual {:.2g}",
                           report.poisson->iterations, report.poisson->residual));
  if (report.graph_cut) warn_unproved(*report.graph_cut, params.method, trace);
}

void announce_energy(const Certificate& c, const ReconstructParams& params, Trace& trace) {
  if (is_certified(params.method))
    trace.info(fmt::format("segmentation proved within {:.2g} % of the global optimum", 100 * c.relative_gap_binary()));
  else
    trace.info(fmt::format("energy {:.6g} (method {} proves no bound of it)", c.binary.primal, name_of(params.method)));
}

void announce_leaves(const Certificate& c, Method method, const ReportDetails& details, Trace& trace) {
  if (!details.of_grid) return;
  if (!is_certified(method)) {
    trace.info(fmt::format("all levels: energy {:.6g}", c.binary.primal));
    if (details.solve.leaf_cut) warn_unproved(*details.solve.leaf_cut, method, trace);
    return;
  }
  trace.info(fmt::format("all levels: proved within {:.2g} % of the global optimum, {:.0f} % of that where levels meet",
                         100 * c.relative_gap_binary(), 100 * details.gap_at_borders / c.binary.gap));
}

void announce_components(const ComponentReport& report, const ReconstructParams& params, Trace& trace) {
  if (report.objects.dropped + report.cavities.dropped == 0) return;
  const auto counted = [](size_t n, const char* one, const char* many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
  };
  trace.info(fmt::format("{} and {} dropped: only {} on their {:.3g} voxel^2 (--min-support {:g})",
                         counted(report.objects.dropped, "component", "components"),
                         counted(report.cavities.dropped, "cavity", "cavities"),
                         counted(report.samples, "sample", "samples"), report.area, params.components.min_support));
}

namespace {

void announce_plan(const MemoryBudget& memory, Trace& trace) {
  constexpr double much = 1.1;
  const auto first = static_cast<double>(memory.first_bytes()), now = static_cast<double>(memory.planned_bytes());
  if (now > much * first || first > much * now)
    trace.info(fmt::format("memory {}, now that the surface is known", memory.summary()));
}

}  // namespace

void announce_refinement(const std::optional<FitReport>& report, const MemoryBudget& memory,
                         const ReconstructParams& params, Trace& trace) {
  announce_plan(memory, trace);
  if (!report) return;
  const FitReport& refine = *report;
  const FitWeights& fit_weights = refine.fit_weights;
  trace.info(fmt::format(
      "refined: estimated noise (1 sigma) {:.2g} voxel, curvature weight {:.2g}{}, directions used {}{}",
      fit_weights.noise, fit_weights.smoothing, params.refine.smoothing ? " (--smoothing)" : "",
      fit_weights.normals > 0 ? "as normals" : "for inside/outside only, not as normals",
      refine.spacing > 1 ? fmt::format(", on every {:g}{} vertex", refine.spacing, refine.spacing == 2 ? "nd" : "th")
                         : ""));
  if (const size_t n = refine.vanished; n > 0)
    trace.info(fmt::format("{} small component{} or cavit{} dropped: refining left nothing of {}", n, n == 1 ? "" : "s",
                           n == 1 ? "y" : "ies", n == 1 ? "it" : "them"));
}

void announce_trim(const TrimReport& trim, const TrimParams& params, Trace& trace) {
  if (trim.nothing_near) {
    trace.warn(fmt::format("not trimmed: no surface is within {:.3g} of a sample; try a larger --trim", trim.distance));
  }
  if (trim.shells > 0)
    trace.info(fmt::format("{} closed part{} inside out dropped", trim.shells, trim.shells == 1 ? "" : "s"));
  if (trim.removed + trim.filled == 0) return;
  trace.info(fmt::format(
      "trimmed: {:.2g} % of the area, farther than {:.3g} from any sample{}{}", 100 * trim.removed_area, trim.distance,
      trim.unfaced > 0 ? " or facing none" : "",
      trim.filled == 0
          ? std::string()
          : fmt::format("; {} hole{} stay{} filled ({})", trim.filled, trim.filled == 1 ? "" : "s",
                        trim.filled == 1 ? "s" : "",
                        params.fill_holes ? fmt::format("at most {:g} wide", *params.fill_holes) : "--trim-holes")));
}

namespace {

/// Empty where the noise of the samples is no reason to lose them. The voxel that helps is the one that would be
/// chosen.
std::string too_noisy(double noise, const ReconstructReport& report) {
  constexpr double notably = 1.1;
  const double helps = default_voxel_over_noise * noise;
  if (helps < notably * report.grid.voxel) return {};
  return fmt::format(
      "their noise, about {:.2g}, is large for this grid; the mesh passes through their middle; try a "
      "larger --voxel, such as {:.2g}",
      noise, helps);
}

/// The most likely cause of lost samples, and what to try; half a line.
std::string cause_of_loss(const ReconstructReport& report) {
  constexpr double mostly = 0.6;
  const SelfCheckReport& check = report.self_check;
  const double lost = check.lost * static_cast<double>(report.input.samples);
  if (report.params.method == Method::vrip) return "seen at grazing angles or by one ray alone; try --method tv";
  if (std::string noise = too_noisy(check.noise * report.grid.voxel, report); !noise.empty()) return noise;
  if (check.alone > mostly)
    return fmt::format(
        "mostly outliers ({:.0f} % of these), far from all others; if a part is missing, try a smaller --voxel or "
        "--lambda",
        100 * check.alone);
  if (std::string noise = too_noisy(report.input.noise, report); !noise.empty()) return noise;
  if (check.outliers > mostly)
    return fmt::format(
        "{:.0f} % of these lie where samples show no surface, as in the crowns of trees; if a part is missing, try a "
        "smaller --voxel or --lambda",
        100 * check.outliers);
  if (report.trim && report.trim->leftovers > 0 && report.trim->removed_area > 0.1)
    return "pieces around a few samples were trimmed; try a larger --trim";
  if (report.components && 2.0 * static_cast<double>(report.components->samples) > lost)
    return "components that few samples support were dropped; try --drop-components off";
  return "parts too thin or too sparsely sampled for this grid and lambda; try a smaller --voxel or "
         "--lambda";
}

/// Empty where all is well.
std::string misplaced_scanners(const ReconstructReport& report) {
  constexpr double some = 0.1;    // share of the scanners
  constexpr double unseen = 0.2;  // share of the surface
  const ScannerReport& s = report.scanners;
  const auto all = static_cast<double>(s.scanners);
  const Border border = report.outside;
  if (border != Border::open && static_cast<double>(s.in_solid) > some * all)
    return fmt::format(
        "{} of {} scanner positions lie inside solid matter: directions point to the wrong side, or what lies "
        "beyond the samples is wrong; try --outside {}",
        s.in_solid, s.scanners, border == Border::solid ? "air" : "solid");
  if (border == Border::air && static_cast<double>(s.enclosed) > some * all && report.self_check.invented > unseen)
    return fmt::format(
        "{} of {} scanner positions lie in a closed shell, {:.0f} % of whose surface no sample is near: "
        "its outer side is invented; try --outside solid",
        s.enclosed, s.scanners, 100 * report.self_check.invented);
  return {};
}

/// Were most directions estimated, without a scanner's place and without knowing from where the scene was seen? Who has
/// asked for what lies beyond the box has thought of that.
bool sides_are_guessed(const ReconstructReport& report) {
  const OrientReport& d = report.input.directions;
  return 2 * d.estimated > report.input.samples && d.from_sensor + d.from_scan == 0 && d.assumed.empty() &&
         report.params.border.outside == Border::automatic;
}

/// Empty where all is well.
std::string made_up_surface(const ReconstructReport& report) {
  constexpr double much = 0.3;  // of the surface
  const double invented = report.self_check.invented;
  const Method method = report.params.method;
  // vrip's surface closes nothing, and only tv's can end at the box.
  if (method == Method::vrip || report.outside == Border::open || report.trim || !(invented > much)) return {};
  return fmt::format(
      "{:.0f} % of the mesh is farther than {:g} voxels from all samples: it closes what was not scanned{}",
      100 * invented, self_check_reach,
      sides_are_guessed(report) ? ", or the guess of the samples' sides is wrong; try --sensor X,Y,Z"
      : method == Method::tv    ? "; try --outside open, or --trim auto"
                                : "; try --trim auto");
}

}  // namespace

void announce_simplification(const SimplifyReport& report, double voxel, Trace& trace) {
  trace.info(fmt::format("simplified: {} of {} triangles ({:.2g} %), proved within {:.2g} voxel of the full mesh",
                         report.triangles, report.triangles_before,
                         100 * static_cast<double>(report.triangles) / static_cast<double>(report.triangles_before),
                         report.proved / voxel));
}

void announce_self_check(const ReconstructReport& report, Trace& trace) {
  const SelfCheckReport& check = report.self_check;
  trace.info(
      fmt::format("self-check: {:.2g} % of the samples are farther than {:g} voxels from the mesh, {:.2g} % of "
                  "the mesh from all samples",
                  100 * check.lost, self_check_reach, 100 * check.invented));
  if (check.lost > self_check_most_lost)
    trace.warn(fmt::format("{:.2g} % of the samples are farther than {:g} voxels from the mesh: {}", 100 * check.lost,
                           self_check_reach, cause_of_loss(report)));
  std::string text = misplaced_scanners(report);
  if (text.empty()) text = made_up_surface(report);
  if (!text.empty()) trace.warn(std::move(text));
}

void announce_volumes(const VolumeInterval& volumes, double voxel, Trace& trace) {
  const double of_vertex = voxel * voxel * voxel;
  trace.info(
      fmt::format("segmentations within {} voxels, of an energy at most {:g} above the optimum: volume {:.6g} to "
                  "{:.6g}, this one {:.6g}",
                  interval_reach, volumes.epsilon, volumes.least * of_vertex, volumes.most * of_vertex,
                  volumes.segmented * of_vertex));
}

void announce_measures(const ReconstructReport& report, Trace& trace) {
  const MeasureReport& m = report.measure;
  std::string text = fmt::format("area {:.6g}", m.area);
  if (m.volume) {
    text += fmt::format(", volume {:.6g}", *m.volume);
    text += fmt::format(" +- {:.2g} for each voxel of offset", m.area * report.grid.voxel);
  }
  const auto filled = std::count_if(m.holes.begin(), m.holes.end(), [](const HoleFacts& hole) { return !hole.cut; });
  if (filled > 0)
    text += fmt::format("; {} hole{} filled, {:.2g} % of the area", filled, filled == 1 ? "" : "s",
                        100 * m.filled_area / m.area);
  if (m.volume_flat && m.volume_smooth && *m.volume_flat != *m.volume_smooth)
    text += fmt::format(": filled flat the volume would be {:.6g}", *m.volume_flat);
  trace.info(text);
}

}  // namespace soapfilm
