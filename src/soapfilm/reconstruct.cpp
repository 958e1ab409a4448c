#include "soapfilm/reconstruct.h"

#include "soapfilm/core/memory.h"
#include "soapfilm/mesh/distance.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/pipeline.h"

namespace soapfilm {

namespace {

/// `owned`: the cloud, when it may be freed.
Reconstruction reconstruct(const PointCloud& cloud, PointCloud* owned, const ReconstructParams& params,
                           const Context& context, const PyramidObserver& observe) {
  Pipeline stage(params, context, observe);
  stage.check(cloud);

  // Each sample gets a weak outward direction: its normal, towards the scanner, or estimated.
  auto directions = stage.orient(cloud);

  // The grid: how fine, where, and what it will cost.
  auto samples = stage.place(cloud, directions, owned ? AfterPlacing::freed : AfterPlacing::kept);

  // What area weighs on it, against the samples.
  stage.weigh(cloud, directions, samples);

  // Curless and Levoy's surface needs neither field nor solve: its scans say what is known.
  if (params.method == Method::vrip) {
    auto mesh = stage.fuse(cloud);
    stage.self_check(mesh, samples);
    stage.attribute(mesh, samples);
    return stage.finish(std::move(mesh));
  }
  release(directions);
  release(samples.source);
  if (owned) *owned = {};

  // The data term f = div v (section 4.1).
  auto field = stage.field(samples);

  // What lies beyond the samples' box: air, solid matter, or neither. Around solid matter all that follows works on the
  // complement, its directions turned.
  stage.border(field, samples);

  // Inside or outside: the convex problem (4), coarse to fine, on a thin band; or what it is compared with.
  auto found = stage.solve(field, samples);

  // How far from the global optimum, at most.
  stage.certify(found.level, field);

  // Specks and bubbles that hardly a sample vouches for, such as outliers leave, go. (The certificate speaks of the
  // solution with them.)
  stage.drop_islands(found.level, samples);

  // Scanners stand in the air, and a hollow around one has been seen.
  stage.place_scanners(found.level);

  // The level set moves onto the samples; components and genus stay those of the segmentation, but for what it leaves
  // nothing of.
  const auto surface = stage.refine(found, samples);

  // The level set as a closed, manifold mesh.
  auto mesh = stage.extract(surface);

  // Where the surface bends, triangles of a voxel are too coarse for what the samples tell.
  stage.bend(mesh, surface, samples);

  // The complement's faces turn back; what closed a sheet along the box goes.
  stage.finish_border(mesh);

  // Where a surface may end, what no sample is near goes, too.
  stage.trim(mesh, samples);

  // Whether it holds what the samples saw, by a part of both.
  stage.self_check(mesh, samples);
  stage.attribute(mesh, samples);
  return stage.finish(std::move(mesh));
}

}  // namespace

Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Context& context,
                           const PyramidObserver& observe) {
  return reconstruct(cloud, nullptr, params, context, observe);
}

Reconstruction reconstruct(PointCloud&& cloud, const ReconstructParams& params, const Context& context,
                           const PyramidObserver& observe) {
  PointCloud owned = std::move(cloud);
  return reconstruct(owned, &owned, params, context, observe);
}

void check_result(Reconstruction& result, const PointCloud& cloud, const Context& context) {
  result.report.topology = check_topology(result.mesh);
  result.report.sample_distance = point_to_mesh_distance(cloud.positions, result.mesh, context);
}

}  // namespace soapfilm
