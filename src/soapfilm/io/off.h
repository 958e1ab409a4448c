// Object File Format meshes (Geomview): OFF with the vertex prefixes ST, C and N, as text.
#pragma once

#include "soapfilm/io/byte_source.h"
#include "soapfilm/mesh.h"

namespace soapfilm::io {

Mesh read_off(ByteSource& source);

}  // namespace soapfilm::io
