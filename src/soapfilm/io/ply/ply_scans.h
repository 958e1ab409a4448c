// The scans declared in the header of a PLY, in `obj_info` or `comment` lines:
//
//   scan_samples N      begins a scan of N samples; without such a line the whole file is one scan
//   scan_name NAME      the scan's name; otherwise the file's
//   sensor X Y Z        the scanner's position
//   view_direction X Y Z   towards the scanner (parallel rays)
//   num_cols N, num_rows N   size of its range grid (Stanford)
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io/ply/ply_header.h"

namespace soapfilm::io {

struct PlyScan {
  Scan scan;            ///< without the samples of the range grid
  int64_t columns = 0;  ///< of its range grid; 0: none
  int64_t rows = 0;

  /// Cells of the range grid; 0 when a size is absent.
  uint64_t cells() const { return static_cast<uint64_t>(columns) * static_cast<uint64_t>(rows); }
};

/// The file's scans, at least one, covering `samples` samples. A `sensor` or `view_direction` line without three
/// numbers is an ordinary comment. Throws InputError when the sum of the scans' counts is wrong.
std::vector<PlyScan> find_scans(const PlyHeader& header, uint64_t samples, const std::string& path);

}  // namespace soapfilm::io
