// Whether a range grid was seen from a place: files name a default place as readily as a scanner's.
#pragma once

#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm::io {

/// unclear: too few samples, or a scene (such as a plane) that looks so from many places.
enum class GridView { unclear, seen_from, not_from };

/// Compares the grid of `scan` with two kinds of images about the place `from`: a perspective image, as of a depth
/// camera, and an angular one, as of a scanner that turns about an axis. Seen from there: one of them fits, and does
/// not about places beside it. `positions`: of the cloud, in the frame of `from`.
GridView judge_view(const std::vector<Vec3d>& positions, const Scan& scan, const Vec3d& from);

/// Is the place at most so many diagonals of the samples' box away from the box?
bool is_near_samples(const std::vector<Vec3d>& positions, const Scan& scan, const Vec3d& from, double diagonals);

/// Is a default place where the scanner of these samples stood? Then they are around it and in a grid that was seen
/// from there. `unless_contradicted`: if it is unclear how the grid was seen, too.
bool is_scanner_place(const std::vector<Vec3d>& positions, const Scan& scan, const Vec3d& from,
                      bool unless_contradicted);

}  // namespace soapfilm::io
