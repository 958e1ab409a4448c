#include "soapfilm/report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "soapfilm/core/json_text.h"
#include "soapfilm/core/method.h"
#include "soapfilm/core/names.h"
#include "soapfilm/finish/self_check.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/run/details.h"
#include "soapfilm/version.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

ordered_json vector_json(const Vec3d& v) { return {v.x, v.y, v.z}; }
ordered_json vector_json(const Vec3i& v) { return {v.x, v.y, v.z}; }

ordered_json input_json(const InputFacts& input) {
  const OrientReport& d = input.directions;
  return {
      {"samples", input.samples},
      {"dropped", input.dropped},
      {"no_return", input.no_return},
      {"scans", input.scans},
      {"box", {{"lo", vector_json(input.box.lo)}, {"hi", vector_json(input.box.hi)}}},
      {"coordinate_system", input.coordinate_system.empty() ? ordered_json() : ordered_json(input.coordinate_system)},
      {"samples_per_voxel2", input.density},
      {"noise", input.noise > 0 ? ordered_json(input.noise) : ordered_json()},
      {"directions",
       {{"normals", d.from_normals},
        {"sensor", d.from_sensor},
        {"scan", d.from_scan},
        {"planes", d.from_planes},
        {"far_planes", d.far_planes},
        {"no_plane", d.without_plane},
        {"estimated", d.estimated},
        {"assumed", d.assumed.empty() ? ordered_json() : ordered_json(d.assumed)},
        {"none", d.without_direction},
        {"contradicting", d.contradicting},
        {"reoriented", d.reoriented}}}};
}

ordered_json grid_json(const ReconstructReport& report) {
  const Lattice lattice{report.grid, {}};
  ordered_json levels = ordered_json::array();
  const Certificate& of_grid = report.details->of_grid ? *report.details->of_grid : report.certificate;
  for (const LevelReport& l : report.details->solve.levels) {
    const double lambda = l.lambda_share * report.certificate.lambda * std::ldexp(1.0, 2 * l.level);
    levels.push_back({{"level", l.level},
                      {"lambda_share", l.lambda_share},
                      {"active_vertices", l.active_vertices},
                      {"iterations", l.iterations},
                      {"tolerance", l.tolerance},
                      {"converged", l.converged},
                      {"stop", name_of(l.stop)},
                      {"band_growths", l.band_growths},
                      {"relative_gap", l.energies.relative_gap(lambda)},
                      {"relative_gap_band", l.energies.relative_gap_band(lambda)},
                      {"relative_gap_binary", l.level > 0    ? ordered_json(l.binary.relative_gap(lambda))
                                              : l.level == 0 ? ordered_json(of_grid.relative_gap_binary())
                                                             : ordered_json()}});
  }
  return {{"size", vector_json(lattice.to_world_axes(lattice.size))},
          {"voxel", lattice.voxel},
          {"first_vertex", vector_json(lattice.first_vertex)},
          {"padding", lattice.padding},
          {"inside", report.certificate.inside},
          {"levels", levels},
          {"leaves", report.details->leaves},
          {"leaf_voxel", report.details->leaves.empty() ? ordered_json() : ordered_json(report.details->leaf_voxel)}};
}

/// Methods without a dual prove no bound: only their energies are reported. vrip has none.
ordered_json certificate_json(const Certificate& c, Method method) {
  if (method == Method::vrip) return nullptr;
  if (!is_certified(method))
    return {{"lambda", c.lambda},
            {"primal_binary", c.binary.primal},
            {"total_variation_binary", c.binary.total_variation},
            {"dual", nullptr},
            {"gap_binary", nullptr},
            {"relative_gap_binary", nullptr}};
  return {{"lambda", c.lambda},
          {"primal", c.relaxed.primal},
          {"primal_binary", c.binary.primal},
          {"dual", c.relaxed.dual},
          {"gap", c.relaxed.primal - c.relaxed.dual},
          {"gap_binary", c.binary.primal - c.binary.dual},
          {"relative_gap", c.relative_gap()},
          {"relative_gap_binary", c.relative_gap_binary()},
          {"gap_per_area", c.gap_per_area()},
          {"gap_per_area_binary", c.gap_per_area_binary()},
          {"total_variation", c.relaxed.total_variation},
          {"total_variation_binary", c.binary.total_variation},
          {"max_dual_norm", c.relaxed.max_dual_norm}};
}

/// Where there are several levels that of all, with the grid's inside.
ordered_json certificate_json(const ReconstructReport& report) {
  ordered_json json = certificate_json(report.certificate, report.params.method);
  const ReportDetails& details = *report.details;
  if (!details.of_grid) return json;
  json["gap_where_levels_meet"] =
      is_certified(report.params.method) ? ordered_json(details.gap_at_borders) : ordered_json();
  json["of_grid"] = certificate_json(*details.of_grid, report.params.method);
  return json;
}

ordered_json cut_json(const GraphCutReport& g) {
  return {{"vertices", g.vertices},       {"links", g.links},
          {"growths", g.growths},         {"flow", g.flow},
          {"energy", g.energy},           {"globally_optimal", g.globally_optimal},
          {"graph_bytes", g.graph_bytes}, {"seconds", g.seconds}};
}

/// The report of the chosen method alone.
ordered_json method_json(const ReconstructReport& report) {
  ordered_json json = {{"name", name_of(report.params.method)}};
  if (!report.details->solve.sor.empty()) json["levels"] = ordered_json::array();
  for (const SorLevelReport& l : report.details->solve.sor)
    json["levels"].push_back({{"level", l.level},
                              {"iterations", l.iterations},
                              {"converged", l.converged},
                              {"bytes", l.bytes},
                              {"energy", l.energy},
                              {"seconds", l.seconds}});
  if (const auto& p = report.details->solve.poisson)
    json.update({{"iterations", p->iterations},
                 {"converged", p->converged},
                 {"residual", p->residual},
                 {"residuals", p->residuals},
                 {"energy", p->energy},
                 {"unknowns", p->unknowns},
                 {"bytes", p->bytes}});
  if (const auto& g = report.details->solve.graph_cut) json.update(cut_json(*g));
  if (const auto& g = report.details->solve.leaf_cut) json["leaves"] = cut_json(*g);
  if (const auto& v = report.details->vrip)
    json.update({{"scans", v->scans},
                 {"triangles", v->triangles},
                 {"dropped_triangles", v->dropped_triangles},
                 {"vertices_seen", v->vertices_seen}});
  return json;
}

ordered_json components_json(const ComponentReport& r, const ComponentParams& params) {
  const auto counts = [](const ComponentReport::Count& c) {
    return ordered_json{{"kept", c.kept}, {"dropped", c.dropped}};
  };
  return {{"objects", counts(r.objects)},
          {"cavities", counts(r.cavities)},
          {"min_support", params.min_support},
          {"highest_dropped", r.highest_dropped},
          {"lowest_kept", r.lowest_kept},
          {"samples_dropped", r.samples},
          {"area_dropped", r.area},
          {"vertices", r.vertices}};
}

ordered_json refine_json(const FitReport& r) {
  return {{"smoothing", r.fit_weights.smoothing},
          {"normals", r.fit_weights.normals},
          {"noise", r.fit_weights.noise},
          {"agreement_deg", r.search.agreement_deg},
          {"held_out_error", r.search.held_out_error},
          {"held_out_samples", r.search.samples},
          {"candidates", r.search.candidates},
          {"spacing", r.spacing},
          {"holes",
           {{"curved", r.holes.curved},
            {"left_flat", r.holes.left},
            {"rounds", r.holes.rounds},
            {"flips", r.holes.flips},
            {"refused", r.holes.refused}}},
          {"band_vertices", r.band_vertices},
          {"down_weighted", r.down_weighted},
          {"flips", r.flips},
          {"refused", r.refused},
          {"vanished", r.vanished},
          {"iterations", r.iterations}};
}

ordered_json relax_json(const RelaxReport& r) {
  return {{"split_edges", r.split_edges}, {"triangles_before", r.triangles_before}};
}

ordered_json simplify_json(const SimplifyReport& r) {
  return {{"triangles_before", r.triangles_before},
          {"triangles", r.triangles},
          {"tolerance", r.tolerance},
          {"proved_distance", r.proved}};
}

ordered_json trim_json(const TrimReport& r) {
  return {{"distance", r.distance},         {"removed", r.removed},     {"filled", r.filled},
          {"removed_area", r.removed_area}, {"leftovers", r.leftovers}, {"unfaced", r.unfaced},
          {"crossed", r.crossed},           {"shells", r.shells},       {"nothing_near", r.nothing_near}};
}

ordered_json cross_validation_json(const CrossValidationReport& select) {
  ordered_json curve = ordered_json::array();
  for (const CrossValidationPoint& p : select.curve)
    curve.push_back({{"lambda", p.lambda},
                     {"lambda_per_density", p.lambda_per_density},
                     {"error", p.error},
                     {"standard_error", p.standard_error},
                     {"empty_folds", p.empty_folds}});
  return {{"folds", select.folds},
          {"whole_scans", select.whole_scans},
          {"grid", vector_json(select.grid)},
          {"voxel", select.voxel},
          {"best", select.best},
          {"chosen", select.chosen},
          {"curve", curve}};
}

ordered_json border_json(const BorderReport& border) {
  const auto energy = [](const std::optional<double>& e) { return e ? ordered_json(*e) : ordered_json(nullptr); };
  return {{"outside", name_of(border.chosen)},
          {"ends", border.ends},
          {"reason", border.reason},
          {"turned", border.turned},
          {"level", border.level < 0 ? ordered_json(nullptr) : ordered_json(border.level)},
          {"energy_air", energy(border.air)},
          {"energy_solid", energy(border.solid)},
          {"energy_open", energy(border.open)},
          {"energy_open_bound", energy(border.open_bound)},
          {"area_cost", border.area_cost},
          {"border_flux", border.border_flux},
          {"closing", border.closing},
          {"scanners", border.scanners.scanners},
          {"scanners_among_samples", border.scanners.among},
          {"directions_covered", border.scanners.covered}};
}

ordered_json scanners_json(const ScannerReport& r) {
  return {{"looked_at", r.scanners}, {"in_solid", r.in_solid}, {"enclosed", r.enclosed}};
}

ordered_json volumes_json(const VolumeInterval& v, double voxel) {
  const double of_vertex = voxel * voxel * voxel;
  return {{"epsilon", v.epsilon},         {"reach", interval_reach},
          {"least", v.least * of_vertex}, {"segmented", v.segmented * of_vertex},
          {"most", v.most * of_vertex},   {"solves", v.solves}};
}

/// The list of holes ends where it would be longer than all else.
ordered_json measures_json(const MeasureReport& m, const std::optional<VolumeInterval>& near, double voxel) {
  constexpr size_t most_holes = 1000;
  const auto or_null = [](const std::optional<double>& v) { return v ? ordered_json(*v) : ordered_json(nullptr); };
  ordered_json holes = ordered_json::array();
  for (size_t i = 0; i < std::min(m.holes.size(), most_holes); ++i) {
    const HoleFacts& hole = m.holes[i];
    holes.push_back(
        {{"center", vector_json(hole.center)}, {"diameter", hole.diameter}, {"area", hole.area}, {"cut", hole.cut}});
  }
  return {{"area", m.area},
          {"volume", or_null(m.volume)},
          {"volume_per_voxel", m.area * voxel},
          {"seen_area", m.area - m.filled_area},
          {"filled_area", m.filled_area},
          {"volume_flat", or_null(m.volume_flat)},
          {"volume_smooth", or_null(m.volume_smooth)},
          {"volume_interval", near ? volumes_json(*near, voxel) : ordered_json(nullptr)},
          {"hole_count", m.holes.size()},
          {"holes", holes}};
}

ordered_json self_check_json(const SelfCheckReport& r) {
  return {{"reach", self_check_reach}, {"samples", r.samples}, {"places", r.places}, {"lost", r.lost},
          {"outliers", r.outliers},    {"alone", r.alone},     {"noise", r.noise},   {"invented", r.invented}};
}

ordered_json mesh_json(const ReconstructReport& report) {
  ordered_json json = {{"vertices", report.mesh_vertices}, {"triangles", report.mesh_triangles}};
  if (report.topology) {
    const TopologyReport& t = *report.topology;
    json["closed"] = t.closed();
    json["manifold"] = t.manifold();
    json["components"] = t.components.size();
    json["genus"] = t.genus() ? ordered_json(*t.genus()) : ordered_json(nullptr);
  }
  if (report.sample_distance) {
    const DistanceSummary& d = *report.sample_distance;
    json["sample_distance"] = {{"mean", d.mean},
                               {"rms", d.rms},
                               {"maximum", d.maximum},
                               {"percentile95", d.percentile95},
                               {"percentile99", d.percentile99}};
  }
  return json;
}

ordered_json ranks_json(const std::vector<RankTimes>& ranks) {
  ordered_json list = ordered_json::array();
  for (const RankTimes& rank : ranks) {
    ordered_json seconds, cpu_seconds;
    double total = 0;
    for (const StageTime& stage : rank.stages) {
      seconds[stage.name] = stage.elapsed;
      cpu_seconds[stage.name] = stage.cpu;
      total += stage.elapsed;
    }
    list.push_back({{"seconds", seconds},
                    {"cpu_seconds", cpu_seconds},
                    {"exchange_cpu_seconds", rank.exchange_cpu_seconds},
                    {"sent_bytes", rank.sent_bytes},
                    {"exchange_share", total > 0 ? rank.exchange_seconds / total : 0}});
  }
  return list;
}

}  // namespace

double Certificate::gap_per_area() const { return relaxed.gap / (lambda * relaxed.total_variation); }
double Certificate::gap_per_area_binary() const { return binary.gap / (lambda * binary.total_variation); }

std::string to_json(const ReconstructReport& report) {
  ordered_json seconds, cpu_seconds;
  StageTime total;
  for (const StageTime& stage : report.stages) {
    seconds[stage.name] = stage.elapsed;
    cpu_seconds[stage.name] = stage.cpu;
    total.elapsed += stage.elapsed;
    total.cpu += stage.cpu;
  }
  seconds["total"] = total.elapsed;
  cpu_seconds["total"] = total.cpu;
  const Vec3d center = report.input.box.center();
  ordered_json json = {
      {"report_version", report_version},
      {"soapfilm", version},
      {"command", report.command},
      {"parameters", ordered_json::parse(to_json(report.params))},
      {"input", input_json(report.input)},
      {"frame", {{"center", vector_json(center)}, {"scale", report.grid.voxel}}},
      {"grid", grid_json(report)},
      {"method", method_json(report)},
      {"cross_validation",
       report.details->select ? cross_validation_json(*report.details->select) : ordered_json(nullptr)},
      {"border", border_json(report.details->border)},
      {"certificate", certificate_json(report)},
      {"surface",
       {{"isovalue", report.isovalue},
        {"components",
         report.components ? components_json(*report.components, report.params.components) : ordered_json(nullptr)},
        {"refine", report.details->refine ? refine_json(*report.details->refine) : ordered_json(nullptr)},
        {"relax", report.relax ? relax_json(*report.relax) : ordered_json(nullptr)},
        {"trim", report.trim ? trim_json(*report.trim) : ordered_json(nullptr)},
        {"simplify", report.simplify ? simplify_json(*report.simplify) : ordered_json(nullptr)}}},
      {"mesh", mesh_json(report)},
      {"self_check", self_check_json(report.self_check)},
      {"measures", measures_json(report.measure, report.details->volumes, report.grid.voxel)},
      {"scanners", scanners_json(report.scanners)},
      {"seconds", seconds},
      {"cpu_seconds", cpu_seconds},
      {"memory",
       {{"planned_bytes", report.planned_bytes},
        {"peak_bytes", report.peak_bytes},
        {"array_bytes", report.array_bytes}}},
      {"warnings", report.warnings}};
  if (!report.details->ranks.empty()) json["ranks"] = ranks_json(report.details->ranks);
  return json_text(json) + "\n";
}

}  // namespace soapfilm
