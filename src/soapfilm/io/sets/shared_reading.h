// Files that ranks (core/ranks.h) read together: each file is read by one of them, which sends it to the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"
#include "soapfilm/io/sets/read_each.h"

namespace soapfilm::io {

/// Bytes of each file; 0 where there is none. Before anything is read throws ParameterError where ranks have files
/// of other names than rank 0, or other options, and InputError where one is of another size.
std::vector<uint64_t> agreed_file_bytes(const std::vector<std::string>& paths, const ReadOptions& options,
                                        const Context& context);

/// read_each() for a context with ranks: the same on each. Each rank reads as many files at once as the rank with the
/// fewest threads has, and has no more clouds than these and one of each other rank that wait to be appended. Of
/// several files that cannot be read, all ranks throw the error of the first.
PointCloud read_shared(const std::vector<uint64_t>& file_bytes, ReadReport& report, const Context& context,
                       const ReadOne& read);

/// Which of so many ranks reads each file: of any `ranks` files in a row from a multiple of `ranks` on each reads one
/// at most, so that they are appended as they arrive; the largest one the rank with the fewest bytes so far.
std::vector<int> readers_of(const std::vector<uint64_t>& file_bytes, int ranks);

}  // namespace soapfilm::io
