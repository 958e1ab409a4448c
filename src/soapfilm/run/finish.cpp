#include "soapfilm/run/finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/error.h"
#include "soapfilm/finish/measure_result.h"
#include "soapfilm/finish/self_check.h"
#include "soapfilm/finish/vertex_evidence.h"
#include "soapfilm/finish/vertex_gap.h"
#include "soapfilm/run/announce.h"
#include "soapfilm/run/defaults.h"
#include "soapfilm/simplify.h"

namespace soapfilm {

ReconstructReport facts_of(const PointCloud& cloud, const Box3d& box, const ReconstructParams& params,
                           const OrientReport& directions, const Grid& grid, const Lambda& lambda,
                           const std::shared_ptr<ReportDetails>& details) {
  ReconstructReport report;
  report.params = params;
  report.input = {cloud.size(), 0,          0,         cloud.scans.size(), box, cloud.coordinate_system,
                  grid.density, directions, grid.noise};
  report.grid = grid.lattice;
  report.certificate.lambda = lambda.value;
  details->select = lambda.select;
  report.details = details;
  return report;
}

void report_border(const BorderReport& border, const Lattice& lattice, ReconstructReport& report,
                   ReportDetails& details) {
  report.outside = border.chosen;
  report.outside_reason = border.reason;
  report.grid = lattice;
  details.border = border;
}

void carry(const SampleAttributes& attributes, const GridSamples& samples, const Lattice& lattice, Trace& trace,
           const Context& context, Mesh& mesh) {
  if (attributes.empty()) return;
  trace.stage("attributes", [&] { carry_attributes(attributes, samples, lattice, context, mesh); });
}

void carry(const std::optional<GapField>& gap, const Lattice& lattice, Trace& trace, const Context& context,
           Mesh& mesh) {
  if (!gap) return;
  trace.stage("gap", [&] { mesh.attributes.push_back({"gap", vertex_gap(mesh, *gap, lattice, context)}); });
}

namespace {

FillDifference fill_of(const ReconstructReport& report) {
  const auto& refine = report.details->refine;
  return {report.params.refine.holes == HoleFill::flat || !refine, refine ? refine->holes.gained : 0};
}

/// The tolerance in input units; none: the number of triangles decides.
double tolerance_of(const SimplifyParams& params, double noise, double voxel) {
  constexpr double least_vox = 0.02, of_noise = 1.0 / 12;
  if (params.tolerance) return *params.tolerance;
  return params.tolerance_vox ? *params.tolerance_vox * voxel : std::max(least_vox * voxel, of_noise * noise);
}

/// Of the mesh with all its attributes, which come along.
SimplifyReport simplify_as_asked(Mesh& mesh, const ReconstructReport& report, double voxel, const Context& context) {
  const SimplifyParams& params = report.params.simplify;
  const double noise = report.refine ? report.refine->noise * voxel : report.input.noise;
  Simplified result = params.triangles ? simplify_to(mesh, *params.triangles, context)
                                       : simplify(mesh, tolerance_of(params, noise, voxel), context);
  mesh = std::move(result.mesh);
  return result.report;
}

}  // namespace

Reconstruction finish(Mesh mesh, ReconstructReport report, const GridSamples& samples, const Lattice& lattice,
                      const MemoryBudget& memory, Trace& trace, const Context& context) {
  report.self_check = trace.stage("self-check", [&] { return self_check(mesh, samples, lattice, context); });
  announce_self_check(report, trace);
  report.measure = trace.stage("measure", [&] {
    return measure_result(mesh, samples, lattice, report.input.density, report.trim, fill_of(report), context);
  });
  announce_measures(report, trace);
  const bool distance = report.params.surface.distance, support = report.params.surface.support;
  if (distance || support)
    trace.stage("evidence", [&] {
      VertexEvidence found = vertex_evidence(mesh, samples, lattice, distance, support, context);
      if (distance) mesh.attributes.push_back({"distance", std::move(found.distance)});
      if (support) mesh.attributes.push_back({"support", std::move(found.support)});
    });
  if (simplifies(report.params.simplify)) {
    try {
      trace.stage("simplify", [&] { report.simplify = simplify_as_asked(mesh, report, lattice.voxel, context); });
      announce_simplification(*report.simplify, lattice.voxel, trace);
    } catch (const ParameterError& error) {  // some methods' surfaces touch themselves
      trace.warn(fmt::format("not simplified: {}", error.what()));
    } catch (const MemoryError& error) {
      trace.warn(fmt::format("not simplified: {}", error.what()));
    }
  }
  report.mesh_vertices = mesh.vertices.size();
  report.mesh_triangles = mesh.triangles.size();
  report.stages = trace.times();
  report.warnings = trace.warnings();
  report.planned_bytes = memory.planned_bytes();
  report.peak_bytes = peak_memory_bytes();
  report.array_bytes = pages_of(context).peak_bytes();
  return {std::move(mesh), std::move(report)};
}

}  // namespace soapfilm
