// Weak directions: which side of the surface each sample was seen from.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/core/context.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/core/progress.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/orient/sides.h"

namespace soapfilm {

/// Where directions come from. A sample for which the chosen source has nothing takes the next one of normals,
/// sensor, scan, estimate; `automatic` begins with normals.
enum class DirectionSource {
  automatic,  ///< normals first; without their signs where these contradict each other, as doubt_signs() says
  normals,    ///< the given normal as it is, unless it is zero
  sensor,     ///< towards the scanner's position: the sample's own, its scan's, or OrientParams::sensor
  scan,       ///< one direction for a whole scan: its viewing direction, or from its mean towards its scanner
  estimate    ///< normal of a plane through the neighbours, turned to the scanner where one is known
};

struct OrientParams {
  DirectionSource source = DirectionSource::automatic;
  std::optional<Vec3d> sensor;   ///< scanner position of the scans that name none, input units and frame
  int neighbours = 16;           ///< of a sample, for estimated normals; in [3, 1000]
  std::optional<double> radius;  ///< estimated normals: all samples as near as this count, too; > 0, input units
  bool from_within = false;      ///< estimated normals whose side nothing tells look inward: BorderParams::outside says
};

/// Throws ParameterError when `neighbours`, `radius` or `sensor` is out of range.
void validate(const OrientParams& params);

struct OrientReport {
  size_t from_normals = 0;
  size_t from_sensor = 0;
  size_t from_scan = 0;
  size_t from_planes = 0;  ///< of those two, by `automatic`: now normals of the planes around them, on that side
  size_t estimated = 0;
  bool inward = false;           ///< normals that were given point towards the samples' middle on the whole
  size_t without_direction = 0;  ///< their direction is zero: no neighbours that span a plane
  double contradicting = 0;      ///< share of the pairs of neighboring directions on one plane that do, [0, 1]
  size_t turned = 0;             ///< normals that were therefore used without their signs: turned round since
  std::vector<std::string> warnings;
};

/// A unit vector for each sample, on the outer side of the surface or meant to be; zero where nothing is known.
///
/// Estimated normals are those of a principal component analysis of the nearest different positions (Hoppe et al.
/// 1992). Where no scanner is known their signs are propagated over a minimum spanning tree of neighbours (same paper),
/// apart for each connected component; a component's sign follows from neighbours with a known direction or, without
/// any, from its extreme samples, which look outward (`from_within`: inward). That is right for a closed surface and a
/// guess for a patch: the report warns. The result does not depend on the number of threads.
///
/// Throws ParameterError when `neighbours`, `radius` or `sensor` is out of range, or when a source that was asked for
/// has nothing for any sample; SamplesError when scans are not in order.
std::vector<Vec3f> orient(const PointCloud& cloud, const OrientParams& params, const Context& context,
                          OrientReport& report);

/// Looks whether the signs of the given normals contradict each other (SideTally). Where they do, and `automatic` was
/// asked for, `directions` of samples with normals become these without their signs: turned to the scanner where one is
/// known, the others by propagation as estimated normals are. One warning says so. Not where many samples lie on thin
/// sheets and no scanner is known: propagation cannot tell their two sides apart. Tells whether `directions` changed.
bool doubt_signs(const PointCloud& cloud, const OrientParams& params, const SideTally& sides, const Context& context,
                 std::vector<Vec3f>& directions, OrientReport& report);

/// A direction towards the scanner tells the outer side of the surface, but counts by the cosine of its angle to the
/// normal: a floor that rays graze at 80 degrees weighs a sixth. Where `surface` has a plane around a sample that has
/// no normal of its own, the plane's normal on the direction's side takes its place.
void turn_to_planes(const PointCloud& cloud, const LocalSurface& surface, const Context& context,
                    std::vector<Vec3f>& directions, OrientReport& report);

}  // namespace soapfilm
