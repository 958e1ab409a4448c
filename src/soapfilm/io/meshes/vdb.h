// The signed distance to a mesh as an OpenVDB grid (.vdb), for rendering and simulation.
#pragma once

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"

namespace soapfilm::io {

/// A level set of 3 cells on both sides of a closed mesh, in input units, negative inside; cells have the edge
/// WriteOptions::voxel. Throws OutputError for an open mesh, and if the library was built without OpenVDB.
WriteReport write_vdb(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context);

}  // namespace soapfilm::io
