#include "tools/evaluate/evaluation_report.h"

#include <fmt/format.h>

#include <optional>

#include "soapfilm/version.h"
#include "tools/mesh/json.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

constexpr int evaluation_version = 1;

ordered_json summary_json(const DistanceSummary& d, double unit) {
  return {{"mean", d.mean / unit},
          {"rms", d.rms / unit},
          {"percentile95", d.percentile95 / unit},
          {"percentile99", d.percentile99 / unit},
          {"maximum", d.maximum / unit}};
}

ordered_json distances_json(const DistanceSummary& d, double voxel) {
  return {{"points", d.count},
          {"distance", summary_json(d, 1.0)},
          {"distance_voxels", voxel > 0 ? summary_json(d, voxel) : ordered_json(nullptr)}};
}

ordered_json directed_json(const DirectedError& error, double voxel) {
  ordered_json json = distances_json(error.distance, voxel);
  json["normal_angle_deg"] = nullptr;
  if (error.angle.count > 0) {
    json["normal_angle_deg"] = {{"points", error.angle.count}};
    json["normal_angle_deg"].update(summary_json(error.angle, 1.0));
  }
  return json;
}

ordered_json compared_json(const Compared& c) {
  return {{"mesh", or_null(c.mesh)}, {"truth", or_null(c.truth)}, {"relative_error", or_null(c.relative_error())}};
}

ordered_json topology_json(const TopologyReport& t) {
  return {{"vertices", t.vertices},
          {"triangles", t.triangles},
          {"closed", t.closed()},
          {"manifold", t.manifold()},
          {"watertight", t.watertight()},
          {"components", t.components.size()},
          {"genus", or_null(t.genus())},
          {"boundary_edges", t.boundary_edges},
          {"non_manifold_edges", t.non_manifold_edges},
          {"non_manifold_vertices", t.non_manifold_vertices}};
}

std::string row(const std::string& name, const DistanceSummary& d, double unit, const char* format) {
  std::string line = fmt::format("{:<20}", name);
  for (const double value : {d.mean, d.rms, d.percentile95, d.percentile99, d.maximum})
    line += fmt::format(fmt::runtime(format), value / unit);
  return line + "\n";
}

std::string angle_row(const std::string& name, const DirectedError& error) {
  const size_t left_out = error.distance.count - error.angle.count;
  if (error.angle.count == 0) return fmt::format("{:<20} none: no triangle there has area\n", name);
  std::string line = row(name, error.angle, 1.0, "{:>11.3f}");
  if (left_out > 0) line += fmt::format("{:<20} {} points left out: the triangle there has no area\n", "", left_out);
  return line;
}

std::string percent(double share) { return fmt::format("{:.2f} %", 100.0 * share); }

std::string compared_line(const char* name, const Compared& c) {
  const auto value = [](const std::optional<double>& v) { return v ? fmt::format("{:.6g}", *v) : "none (open)"; };
  std::string line = fmt::format("{:<20} {}, true {}", name, value(c.mesh), value(c.truth));
  if (const auto error = c.relative_error()) line += fmt::format(", error {:+.3g} %", 100.0 * *error);
  return line + "\n";
}

}  // namespace

std::string evaluation_table(const EvaluationSubject& subject, const Evaluation& e) {
  std::string text =
      fmt::format("{:<20}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "", "mean", "rms", "95 %", "99 %", "maximum");
  const auto distances = [&](const char* name, const DistanceSummary& d) {
    text += row(name, d, 1.0, "{:>11.3e}");
    if (subject.voxel > 0) text += row("  in voxels", d, subject.voxel, "{:>11.4f}");
  };
  distances("truth to mesh", e.truth_to_mesh.distance);
  distances("mesh to truth", e.mesh_to_truth.distance);
  if (e.samples_to_mesh) distances("samples to mesh", *e.samples_to_mesh);
  text += "normals, degrees\n";
  text += angle_row("  truth to mesh", e.truth_to_mesh);
  text += angle_row("  mesh to truth", e.mesh_to_truth);
  for (const FScore& f : e.f_scores)
    text += fmt::format("{:<20} {}: precision {}, recall {}\n", fmt::format("F-score at {:.4g}", f.distance),
                        percent(f.score()), percent(f.precision), percent(f.recall));
  text += compared_line("volume", e.volume);
  text += compared_line("area", e.area);
  text += fmt::format("{:<20} {}\n", "mesh", summary(e.topology));
  text += fmt::format("{:<20} {}\n", "truth", summary(e.truth_topology));
  text += fmt::format("{:<20} {} pair{} of triangles\n", "self-intersections", e.self_intersections,
                      e.self_intersections == 1 ? "" : "s");
  return text;
}

ordered_json evaluation_json(const EvaluationSubject& subject, const Evaluation& e) {
  const double voxel = subject.voxel;
  ordered_json scores = ordered_json::array();
  for (const FScore& f : e.f_scores)
    scores.push_back(
        {{"distance", f.distance}, {"precision", f.precision}, {"recall", f.recall}, {"f_score", f.score()}});
  return {{"format", "soapfilm evaluation"},
          {"evaluation_version", evaluation_version},
          {"soapfilm", version},
          {"mesh", subject.mesh},
          {"truth", subject.truth},
          {"samples", subject.samples.empty() ? ordered_json(nullptr) : ordered_json(subject.samples)},
          {"voxel", voxel > 0 ? ordered_json(voxel) : ordered_json(nullptr)},
          {"seed", subject.options.seed},
          {"truth_to_mesh", directed_json(e.truth_to_mesh, voxel)},
          {"mesh_to_truth", directed_json(e.mesh_to_truth, voxel)},
          {"samples_to_mesh", e.samples_to_mesh ? distances_json(*e.samples_to_mesh, voxel) : ordered_json(nullptr)},
          {"f_scores", scores},
          {"volume", compared_json(e.volume)},
          {"area", compared_json(e.area)},
          {"topology", {{"mesh", topology_json(e.topology)}, {"truth", topology_json(e.truth_topology)}}},
          {"self_intersections", e.self_intersections}};
}

}  // namespace soapfilm
