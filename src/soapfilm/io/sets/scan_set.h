// Stanford scan sets (.conf): a text file that names scans and their poses. Conventions: docs/reference/formats.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/sets/set_members.h"

namespace soapfilm {

/// A rigid motion as a .conf file writes it: p_world = R p_scan + translation, where R is the TRANSPOSE of the textbook
/// rotation matrix of the unit quaternion (x, y, z, w); in other words R rotates by the conjugate quaternion.
struct ScanPose {
  Vec3d translation;                             ///< input units
  std::array<double, 4> quaternion{0, 0, 0, 1};  ///< x, y, z, w

  Vec3d rotate(Vec3d v) const;
  Vec3d apply(Vec3d p) const { return rotate(p) + translation; }
};

/// One `bmesh` line.
struct ScanSetEntry {
  std::string file;  ///< relative to the .conf file's folder, or absolute
  ScanPose pose;
};

/// The entries of a .conf file, quaternions normalized. Warns of lines with unknown keywords; `camera` and `mesh` lines
/// are for a viewer and are ignored. Throws InputError.
std::vector<ScanSetEntry> read_scan_set(const std::string& path, ReadReport* report = nullptr);

/// Writes a .conf file that read_scan_set() reads back; the caller writes the scans' own files. Throws OutputError.
void write_scan_set(const std::string& path, const std::vector<ScanSetEntry>& entries);

/// Moves a cloud: positions, normals, sensor positions and viewing directions.
void apply_pose(const ScanPose& pose, PointCloud& cloud);

namespace io {

std::vector<SetMember> scan_set_members(ByteSource& source, ReadReport& report);

/// All scans of the set, posed. A scan without a sensor position or a viewing direction of its own was seen along its
/// local +Z axis: its viewing direction becomes R (0, 0, 1).
PointCloud read_scan_set_points(ByteSource& source, ReadReport& report, const ReadOptions& options,
                                const Context& context);

}  // namespace io
}  // namespace soapfilm
