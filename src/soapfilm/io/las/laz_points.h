// Decodes the point records of a chunk of LAZ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "soapfilm/io/las/laz_layout.h"

namespace soapfilm::io {

/// The points of one chunk, in order.
class LazPoints {
 public:
  virtual ~LazPoints() = default;
  /// The next `count` records, one after the other; returns false if the chunk does not hold them.
  virtual bool read(size_t count, char* to) = 0;
};

/// `points` and `bytes`: of the chunk. `wanted`: of each byte of a record, is it needed? The others may be anything.
/// Null if the chunk's head contradicts them.
std::unique_ptr<LazPoints> laz_points(const LazLayout& layout, uint64_t points, std::string_view bytes,
                                      const std::vector<bool>& wanted);

/// One stream of all fields: formats 0 to 5, items of version 1.
std::unique_ptr<LazPoints> laz_version1(const LazLayout& layout, std::string_view bytes);
/// The same, of version 2.
std::unique_ptr<LazPoints> laz_pointwise(const LazLayout& layout, std::string_view bytes);
/// A stream for each field, of which only those with wanted bytes are decoded: formats 6 to 10.
std::unique_ptr<LazPoints> laz_layers(const LazLayout& layout, uint64_t points, std::string_view bytes,
                                      const std::vector<bool>& wanted);

}  // namespace soapfilm::io
