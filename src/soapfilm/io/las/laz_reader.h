// The point records of a LAZ file in order, decoded chunk by chunk on the threads of the context.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/las/laz_layout.h"
#include "soapfilm/io/las/laz_points.h"

namespace soapfilm::io {

class LazReader {
 public:
  /// `wanted`: of each byte of a record, is it needed? The others may be anything. `most_bytes`: of records that are
  /// decoded at once.
  LazReader(ByteSource& source, LazLayout layout, std::vector<bool> wanted, const Context& context,
            size_t most_bytes = size_t{32} << 20);

  /// The next records, of some chunks or of a part of a large one; valid until the next call. Empty after the last.
  /// Throws InputError for a chunk that does not hold its points.
  std::string_view next();

 private:
  std::unique_ptr<LazPoints> open(const LazChunk& chunk) const;
  void read(LazPoints& points, const LazChunk& chunk, size_t count, char* to) const;
  std::string_view read_part();
  [[noreturn]] void fail(const LazChunk& chunk) const;

  ByteSource& source_;
  LazLayout layout_;
  std::vector<bool> wanted_;
  const Context& context_;
  size_t most_points_;  // at once
  size_t next_chunk_ = 0;
  std::unique_ptr<LazPoints> large_;  // the chunk before next_chunk_, of which `left_` points are to be read
  size_t left_ = 0;
  std::vector<char> records_;
};

}  // namespace soapfilm::io
