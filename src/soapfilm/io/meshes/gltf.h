// Meshes as binary glTF 2.0 (.glb), for viewers and the web.
#pragma once

#include <span>

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/levels.h"

namespace soapfilm::io {

/// glTF has 32-bit coordinates: they are relative to the center of the mesh's box, which is the node's translation (in
/// double). A node above it turns WriteOptions::up to y (gltf_up.h). Normals, the faces' where the mesh has none, are
/// NORMAL, colors COLOR_0, attributes _NAME; the one material is seen from both sides where the mesh is open.
WriteReport write_glb(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context);

/// The same, relative to `origin`: parts of one mesh with one origin have the same coordinates where they meet.
WriteReport write_glb_at(AtomicFile& file, const Mesh& mesh, Vec3d origin, const WriteOptions& options);

/// Levels of detail of one surface, the finest first: nodes lod0, lod1, ... The scene has the first, whose extension
/// MSFT_lod names the others: who does not know it shows the finest. Each one's extras have `proved_distance`: that of
/// the level, and what rounding adds.
WriteReport write_glb_levels(AtomicFile& file, std::span<const DetailLevel> levels, const WriteOptions& options);

}  // namespace soapfilm::io
