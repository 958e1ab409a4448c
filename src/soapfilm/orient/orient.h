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
  bool from_within = false;  ///< estimated normals whose side is not known look inward (Border::solid)
};

/// A unit vector for each sample, on the outer side of the surface or meant to be; zero where nothing is known.
///
/// Estimated normals are those of a principal component analysis of the nearest different positions (Hoppe et al.
/// 1992). Where no scanner is known their signs are propagated over a minimum spanning tree of neighbors (same paper),
/// apart for each connected component; a component's sign follows from neighbors with a known direction or, without
/// any, from its extreme samples, which look outward (`from_within`: inward). That is right for a closed surface and a
/// guess for a patch: the report warns. The result does not depend on the number of threads.
///
/// Throws ParameterError when `neighbors`, `radius` or `sensor` is out of range, or when a source that was asked for
/// has nothing for any sample; SamplesError when scans are not in order.
std::vector<Vec3f> orient(const PointCloud& cloud, const OrientSetup& params, const Context& context,
                          OrientReport& report);

/// Looks whether the signs of the given normals contradict each other (SideTally). Where they do, and `automatic` was
/// asked for, `directions` of samples with normals become these without their signs: turned to the scanner where one is
/// known, the others by propagation as estimated normals are. One warning says so. Not where many samples lie on thin
/// sheets and no scanner is known: propagation cannot tell their two sides apart. Tells whether `directions` changed.
bool doubt_signs(const PointCloud& cloud, const OrientSetup& params, const SideTally& sides, const Context& context,
                 std::vector<Vec3f>& directions, OrientReport& report);

/// A direction towards the scanner tells the outer side of the surface, but counts by the cosine of its angle to the
/// normal: a floor that rays graze at 80 degrees weighs a sixth. Where `surface` has a plane around a sample that has
/// no normal of its own, the plane's normal on the direction's side takes its place.
void turn_to_planes(const PointCloud& cloud, const LocalSurface& surface, const Context& context,
                    std::vector<Vec3f>& directions, OrientReport& report);

}  // namespace soapfilm
