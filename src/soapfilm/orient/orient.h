// Weak directions: which side of the surface each sample was seen from.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/orient/sides.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Throws ParameterError when `neighbors`, `radius` or `sensor` is out of range.
void validate(const OrientParams& params);

/// What users set, and what follows from other parameters.
struct OrientSetup : OrientParams {
  bool from_within = false;  ///< estimated normals of unknown side look inward (Border::solid)
};

/// A unit vector for each sample, on the (presumed) outer side of the surface; zero where unknown.
///
/// Estimated normals are those of a principal component analysis of the nearest different positions (Hoppe et al.
/// 1992). Where no scanner is known their signs are propagated over a minimum spanning tree of neighbors (same paper),
/// separately for each connected component; a component's sign follows from neighbors with a known direction or,
/// without any, from its extreme samples, which look outward (`from_within`: inward). That is right for a closed
/// surface and a guess for a patch: the report warns. The result does not depend on the number of threads.
///
/// Throws ParameterError when `neighbors`, `radius` or `sensor` is out of range, or when a requested source has no
/// direction for any sample; SamplesError when scans are not in order.
std::vector<Vec3f> orient(const PointCloud& cloud, const OrientSetup& params, const Context& context,
                          OrientReport& report);

/// Checks whether the signs of the given normals contradict each other (SideStatistics). If so, and with `automatic`,
/// the `directions` of samples with normals are recomputed without their signs: oriented to the scanner where one is
/// known, the others by propagation as for estimated normals. One warning says so. Not done where many samples lie on
/// thin sheets and no scanner is known: propagation cannot distinguish their two sides. Returns whether `directions`
/// changed.
bool check_signs(const PointCloud& cloud, const OrientSetup& params, const SideStatistics& sides,
                 const Context& context, std::vector<Vec3f>& directions, OrientReport& report);

/// A direction towards the scanner shows the outer side of the surface, but its weight is the cosine of its angle to
/// the normal: a floor that rays graze at 80 degrees has a sixth of the weight. Where `surface` has a plane around a
/// sample without a normal of its own, the plane's normal on the direction's side replaces it; where it has none since
/// the samples there lie along a line, the plane comes from beyond the line (far_planes()).
void use_plane_normals(const PointCloud& cloud, LocalSurface& surface, const Context& context,
                       std::vector<Vec3f>& directions, OrientReport& report);

}  // namespace soapfilm
