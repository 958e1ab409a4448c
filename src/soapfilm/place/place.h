// The stage that decides the grid: how fine it is, and where it lies.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/params.h"

namespace soapfilm {

/// The voxel over the samples' noise, at least: so 95 % of the samples are within two voxels of the surface in a room
/// before a depth camera, where the noise of the far half is twice as large.
inline constexpr double default_voxel_over_noise = 1.75;

struct Grid {
  Lattice lattice;
  double density = 0;           ///< samples per voxel^2 of surface
  double area = 0;              ///< of the surface, voxel^2, roughly; 0: unknown
  double noise = 0;             ///< of the samples, standard deviation, input units; 0: unknown
  double default_voxel = 0;     ///< whatever was asked for, input units
  bool voxel_by_noise = false;  ///< not by the samples' spacing
  int finer = 0;                ///< levels that may follow below the lattice, where samples are dense: of 1/2, 1/4, ...
                                ///< voxel
  bool ends = false;            ///< the surface ends where it was not seen: BorderReport, once it is known
  std::vector<float> weights;   ///< of each sample, where clusters of samples hid the spacing; else empty
  std::vector<std::string> warnings;
};

/// What is known of the samples' surface, and from where it was seen.
struct Seen {
  const LocalSurface& surface;
  std::span<const Vec3f> directions;  ///< one for each sample; zero: unknown
  bool from_above = false;            ///< from the air, where what looks like noise are trees
};

/// The voxel as given, or by the spacing of the samples and the thickness of sheets, but not far below the samples'
/// noise: more samples than that say where the surface is, not how it is shaped. The lattice around the samples' box.
/// Where most samples nearly coincide, so that their spacing asks for far more voxels than there are samples, the
/// spacing away from such clusters decides instead, and the samples of a cluster weigh together as much as one.
/// `by_area`: the density is an average over the area, where it could be measured, not over the samples.
/// Throws ParameterError where no such lattice is possible.
Grid place_grid(const PointCloud& cloud, const Box3d& box, const Seen& seen, const PlaceParams& params, bool by_area,
                const Context& context);

/// " (...)", if a thousandth of the samples makes the box at least twice as long: what the box would be without them,
/// and the position of one. Nothing otherwise.
std::string far_samples(const PointCloud& cloud, const Box3d& box);

}  // namespace soapfilm
