// E57 files that tests write and read back.
#pragma once

#include <vector>

#include "e57_writer.h"
#include "files.h"
#include "soapfilm/io.h"

namespace soapfilm::test {

inline PointCloud read_e57_file(const std::vector<E57TestScan>& scans, ReadReport* report = nullptr,
                                const E57TestOptions& options = {}, const ReadOptions& read = {}) {
  const TemporaryFolder folder;
  return read_points(folder.write("scans.e57", E57Writer::file(scans, options)), report, Context(1), read);
}

}  // namespace soapfilm::test
