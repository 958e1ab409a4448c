// The point records of a LAZ file in order, their chunks decoded on the threads of the context.
#pragma once

#include <cstddef>
#include <functional>
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

  /// take(records) for all records, in order: of some chunks or of a part of a large one. It is called by one thread at
  /// a time, while others decode what comes next. Throws InputError for a chunk that does not hold its points.
  void read(const std::function<void(std::string_view)>& take);

 private:
  /// What is decoded at once: whole chunks, or a part of a large one.
  struct Batch {
    size_t first_chunk = 0;
    size_t chunks = 0;
    size_t points = 0;
  };

  Batch next_batch();
  void decode(const Batch& batch, size_t k, char* to);
  std::unique_ptr<LazPoints> open(const LazChunk& chunk) const;
  [[noreturn]] void fail(const LazChunk& chunk) const;

  ByteSource& source_;
  LazLayout layout_;
  std::vector<bool> wanted_;
  const Context& context_;
  size_t most_points_;  // at once
  size_t next_chunk_ = 0;
  std::unique_ptr<LazPoints> large_;  // the chunk before next_chunk_, of which `left_` points are to be read
  size_t left_ = 0;
};

}  // namespace soapfilm::io
