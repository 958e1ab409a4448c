// Several files read at once, as one cloud in their order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"

namespace soapfilm::io {

/// Reads file `i` of those that are read together. On any thread: it must not report progress.
using ReadOne = std::function<PointCloud(size_t i, ReadReport& report)>;

/// Files of so many bytes, as many at once as there are threads, so that no more clouds than that wait to be appended.
/// Ranks share them (shared_reading.h), but one file each reads by itself. Cloud, report and error are those of reading
/// one after the other; after an error the report is incomplete.
PointCloud read_each(const std::vector<uint64_t>& file_bytes, ReadReport& report, const Context& context,
                     const ReadOne& read);

/// To the end of what is there.
void append_file(PointCloud&& cloud, ReadReport&& found, PointCloud& all, ReadReport& report);

}  // namespace soapfilm::io
