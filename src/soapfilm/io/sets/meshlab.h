// MeshLab's projects (.mlp) and alignments (.aln): files of scans and their poses. docs/reference/formats.md.
#pragma once

#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/sets/set_members.h"

namespace soapfilm::io {

std::vector<SetMember> mlp_members(ByteSource& source, ReadReport& report);
std::vector<SetMember> aln_members(ByteSource& source, ReadReport& report);
PointCloud read_mlp(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);
PointCloud read_aln(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);

}  // namespace soapfilm::io
