// A simulated range scanner: what it would measure of a known surface.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/progress.h"
#include "tools/scanner/pose.h"
#include "tools/scanner/surface.h"

namespace soapfilm {

/// fibonacci: spread evenly over a sphere around the target; ring: on circles of the given elevations.
enum class Orbit { fibonacci, ring };
/// central: all rays of a scan start at the scanner (pinhole); parallel: all have one direction; spinning: they start
/// at the scanner, which rotates once about the upright axis z, a ring of rays for each elevation.
enum class Rays { central, parallel, spinning };
/// ray: somewhere else on its ray, still part of the range image; box: anywhere in the box, outside the range image.
enum class Outliers { ray, box };

struct ScannerParams {
  // Where the scanner stands. The "diagonal" is that of the surface's box.
  Orbit orbit = Orbit::fibonacci;
  int views = 18;                          ///< positions on the orbit, on each circle of a ring; 1..10000
  std::vector<double> elevations_deg{30};  ///< of the ring's circles above the target; each in [-90, 90]
  double distance = 1.5;                   ///< from target to scanner, in diagonals; > 0.5, up to 1000
  std::vector<Vec3d> positions;            ///< scanner positions that replace the orbit, input units
  std::optional<Vec3d> target;             ///< the point that every view looks at; default the box's center

  // What it sees.
  Rays rays = Rays::central;
  int columns = 300;  ///< of the range image; 1..20000. Spinning: rays per rotation
  int rows = 300;     ///< spinning: rings, unless `rings_deg` gives them
  double step = 0;  ///< distance between neighboring rays at the target, input units. When > 0 columns and rows follow
                    ///< from it; when 0 it follows from them: the widest view of the box fills the image

  double lowest_deg = -60, highest_deg = 60;  ///< spinning: elevation of the lowest and the highest ring; [-90, 90]
  std::vector<double> rings_deg;              ///< spinning: of each ring instead, from the top; each in [-90, 90]
  double max_range = 0;                       ///< hits farther away are lost, input units; 0: none are

  // Errors.
  double noise = 0;     ///< standard deviation along the ray, input units, >= 0
  double outliers = 0;  ///< share of the samples, [0, 1]
  Outliers outlier_kind = Outliers::ray;
  double drop_out = 0;            ///< share of the hits that are lost, [0, 1)
  double max_incidence_deg = 80;  ///< hits with a larger angle between ray and normal are lost; (0, 90]
  double ghosts = 0;              ///< share of the hits with a delayed, mirrored return: behind the surface; [0, 1]
  double ghost_lo = 1;            ///< how far behind it, along its normal, input units, >= 0
  double ghost_hi = 3;            ///< at most; >= ghost_lo
  double mixed_pixels = 0;        ///< share of the pixels at a step in depth that measure between its sides; [0, 1]
  double misalignment_deg = 0;    ///< standard deviation of each scan's rotation about its center, >= 0
  double misalignment = 0;        ///< standard deviation of its shift along each axis, input units, >= 0

  bool normals = false;  ///< true outward normals with the samples (zero for outliers)
  uint64_t seed = 1;
};

/// Scans in one frame, and their poses, to transform each back to its own.
struct ScanSet {
  PointCloud cloud;         ///< world frame; every scan has its range grid and its sensor or viewing direction
  std::vector<Pose> poses;  ///< one per scan, as registered: with misalignment, not quite where the scanner stood
};

/// Scans `surface`. Range images run row by row from the upper left, as the scanner sees them. Views without hits give
/// no scan. The result depends only on the surface and the parameters, not on the number of threads.
///
/// Throws ParameterError when a parameter is out of range, or when no ray of any view meets the surface.
ScanSet virtual_scan(const Surface& surface, const ScannerParams& params, const Context& context);

/// Where outliers lie: the surface's box, a quarter of its diagonal wider on every side.
Box3d outlier_box(const Box3d& box);

/// The positions that virtual_scan uses for a surface with the given box. Throws ParameterError as it does.
std::vector<Vec3d> scanner_positions(const Box3d& box, const ScannerParams& params);

}  // namespace soapfilm
